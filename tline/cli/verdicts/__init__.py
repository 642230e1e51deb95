"""What `tline passivity` answers, one file for each kind of thing that is asked about."""
