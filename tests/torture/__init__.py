"""Real processes, killed, interrupted and starved while they write: `make torture`.

`jobs` lists commands that write and what they leave, `attacks` ends them or takes their disk,
`checks` looks at every file that is there afterwards, `caches` damages the compiled kernels.
"""
