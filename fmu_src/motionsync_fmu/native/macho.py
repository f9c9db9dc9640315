"""Universal Mach-O files: one library of macOS for several processors."""

BOUNDARY = 14  # each library in the file starts at a multiple of 2^14 bytes, the size of a page on 64-bit ARM


def universal(*thin: bytes) -> bytes:
    """A Mach-O file for several processors: a header, then the library of each processor.

    Source: <mach-o/fat.h>.
    """
    header, body, first = (0xCAFEBABE).to_bytes(4, "big") + len(thin).to_bytes(4, "big"), b"", 1 << BOUNDARY
    for library in thin:
        processor = library[4:12][3::-1] + library[8:12][::-1]  # cpu type and subtype, big-endian
        header += processor + b"".join(n.to_bytes(4, "big") for n in (first + len(body), len(library), BOUNDARY))
        body += library + bytes(-len(library) % first)
    return header.ljust(first, b"\0") + body
