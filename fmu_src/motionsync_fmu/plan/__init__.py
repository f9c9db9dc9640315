"""What a machine that cuts to length can do: predicted from its data, explained, and confirmed by runs of the block."""
