"""Many retargets in worker processes: jobs are planned, handed out, recorded and reported."""
