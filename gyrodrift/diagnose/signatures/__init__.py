"""Named statistics of a recording, each tied to a stage of the rig and a regime of its motion."""
