"""Line ends for messages: boards and phones often send one line of text per message, without its end."""

from gyrodrift.link.heard import PRINTABLE


class LineEnds:
    """Adds a line end to each text without one, until a binary message comes."""

    def __init__(self, *, is_text: bool = True) -> None:
        self._is_binary = not is_text

    def add(self, content: bytes) -> bytes:
        """Message as a part of a stream; a frame may look like text by chance, so binary streams stay as they are."""
        if self._is_binary or content.endswith((b"\n", b"\r")):
            return content
        if all(byte in PRINTABLE or byte >= 0x80 for byte in content):
            return content + b"\n"
        self._is_binary = True
        return content
