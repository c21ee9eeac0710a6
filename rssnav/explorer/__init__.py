"""The explorer: a page in the browser to move the source, see its radio map, and train a UAV.

The page is a Panel application. Each tab has a `rssnav.explorer.session.Session`, which is
independent of the browser: it holds the plan, and traces and trains in threads. The page polls the
session ten times a second and shows what has changed, so only the server's thread touches what the
browser sees. "Source" is the plan's word for the transmitter.
"""
