"""A benchmark of policies that find a radio source in buildings they have not seen.

`protocol` says what is flown and never changes within a version; `buildings` makes the missions;
`policies` are the policies that come with it; `running` flies them and resumes; `scores` and `page`
turn flights into tables.
"""
