"""Submissions to the leaderboard: episodes in one file, which anybody can simulate again (docs/leaderboard.md).

tracks       which episodes a submission must hold, and by which rules they are played
card         what an agent's authors say about it
packing      the archive: a manifest with hashes, and one result for each episode
faults       kinds of faults by name, and what is looked for without a simulation
simulating   every episode again, decision by decision, against its record
report       what a verification saw
signing      signatures of reports, by OpenSSH
commitments  hidden scenes: hashes now, names later
standings    rows, differences and copies out of reports; site writes them as pages
"""
