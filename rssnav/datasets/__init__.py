"""Data sets of radio maps: a spec in, a folder with maps, manifest and data card out.

A spec (`spec`) names plans (`plans`), how buildings are divided (`split`), and what is traced in
each (`configuration`). A piece of work (`work`) traces a plan (`tracing`) into one file
(`container`). Engines do these pieces of work, on threads or on a cluster; `making` keeps what is
finished and describes the whole. `checks` and `exporters` read what was made.
"""
