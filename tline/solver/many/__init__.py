"""Many runs of one scene at once, with numbers that vary from copy to copy: the basis of sweeps of simple scenes."""
