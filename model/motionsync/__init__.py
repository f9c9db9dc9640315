"""Master/slave motion synchronisation: the motion laws and the blocks. Standard library only; no I/O, no FMI."""
