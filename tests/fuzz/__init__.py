"""Mutated inputs for every reader, option and boundary: `make fuzz`.

`targets` lists what is attacked and which errors are right there, `mutations`, `hdf5_files` and
`calls` draw the inputs, `worker` runs them in a process of its own, and `supervisor` watches these
processes for time, memory and crashes.
"""
