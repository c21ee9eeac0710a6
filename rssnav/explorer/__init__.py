"""The explorer: a page in the browser to drag a source, see its radio map, and train a UAV.

The page is a Panel application. Each tab has a `rssnav.explorer.session.Session`, which knows
nothing of browsers: it holds the plan and hands tracing and training to threads. The page looks
ten times a second whether the session has something new and shows it, so no thread but the
server's ever touches what the browser sees.
"""
