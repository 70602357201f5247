#!/usr/bin/env python3
"""Makes `src/pairs.rs`: the canonical decompositions of Latin, Greek and Cyrillic letters, of those that the fonts have or whose
mark they have."""
import unicodedata
from pathlib import Path

# As in `assets/fonts/subset.py`.
MARKS = [0x300, 0x301, 0x302, 0x303, 0x304, 0x307, 0x308]
LETTERS = [*range(0xC0, 0x180), *range(0x384, 0x3CF), *range(0x400, 0x460)]


def parts(code):
    """The decomposition of a character, if it is canonical."""
    text = unicodedata.decomposition(chr(code))
    return [] if text.startswith("<") else [int(part, 16) for part in text.split()]


pairs = [(code, *parts(code)) for code in range(0xC0, 0x2000)
         if len(parts(code)) == 2 and (parts(code)[1] in MARKS or code in LETTERS)
         and unicodedata.name(chr(code)).split()[0] in ("LATIN", "GREEK", "CYRILLIC")]
lines, line = [], "   "
for pair in pairs:
    item = " [" + ", ".join(f"0x{code:x}" for code in pair) + "],"
    if len(line) + len(item) > 125:
        lines.append(line)
        line = "   "
    line += item
text = "\n".join([*lines, line])
Path(__file__).with_name("src").joinpath("pairs.rs").write_text(f"""//! Letters with a mark, made by `pairs.py`.

/// A letter with a mark, the letter, the mark; in the order of the first.
#[rustfmt::skip]
pub(crate) static PAIRS: [[u16; 3]; {len(pairs)}] = [
{text}
];
""")
print(len(pairs), "pairs")
