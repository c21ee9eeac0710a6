"""The study of the choices that the paper does not specify."""
