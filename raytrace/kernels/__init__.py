"""The compiled inner loops: arrays and SI numbers in, arrays out, no checks."""
