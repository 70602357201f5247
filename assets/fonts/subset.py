#!/usr/bin/env python3
"""Makes the font subsets beside this file from Noto's fonts (Debian: fonts-noto-core) with fonttools.

Usage: subset.py [FOLDER OF THE NOTO FONTS]
"""
import sys
from pathlib import Path

from fontTools import subset
from fontTools.ttLib import TTFont

HERE = Path(__file__).parent
SOURCE = Path(sys.argv[1] if len(sys.argv) > 1 else "/usr/share/fonts/truetype/noto")

TEXT = [*range(0x20, 0x7F), *range(0xA0, 0x180), *range(0x384, 0x3CF), *[ord(c) for c in "ϑϕϖϰϱϵ"], *range(0x400, 0x460),
        0x1E8A, 0x1E8B, 0x1E8C, 0x1E8D, 0x300, 0x301, 0x302, 0x303, 0x304, 0x307, 0x308, *range(0x2010, 0x2028),
        0x2030, 0x2032, 0x2033, 0x2039, 0x203A, *range(0x2070, 0x209D), 0x20AC, 0x1D40, 0x2212, *[ord(c) for c in "ˣᵛᵃᵗᵈ"]]
# Headings are English with Greek symbols; other letters come from the regular font.
BOLD = [c for c in TEXT if not (0x100 <= c < 0x180 or 0x384 <= c < 0x391 or 0x3CA <= c < 0x3CF or 0x400 <= c < 0x460)]
SYMBOLS = ([ord(c) for c in "±×·−√∞≈≤≥≠→←↑↓↔∑∫∂∆∈∝∼⟂ᵀ⋅…∥∣≪≫"],
           [ord(c) for c in "▶◀⏵⏴⏶⏷⏸⏹⏺⏭⏮↺↻⟲⟳↶↷⇄☀☾🌙☰✕✖✔✓⚠●○◆◇■□◻▲▼▸▾▴◂⚙🔗⛶⌨➕➖✏"])
FONTS = {"NotoSans-Regular": TEXT, "NotoSans-Bold": BOLD,
         "NotoSansMath-Regular": SYMBOLS[0] + SYMBOLS[1], "NotoSansSymbols2-Regular": SYMBOLS[1],
         "NotoSansSymbols-Regular": SYMBOLS[1]}

covered = set()
for name, wanted in FONTS.items():
    font = TTFont(SOURCE / f"{name}.ttf")
    # Each symbol once; the text fonts are whole in themselves.
    codepoints = [c for c in wanted if c in font.getBestCmap() and (wanted in (TEXT, BOLD) or c not in covered)]
    covered |= set(codepoints)
    options = subset.Options(hinting=False, layout_features=["kern", "mark", "mkmk", "ccmp"], notdef_outline=True,
                             name_IDs=[0, 1, 2, 4, 6, 13, 14], desubroutinize=True)
    subsetter = subset.Subsetter(options)
    subsetter.populate(unicodes=codepoints)
    subsetter.subset(font)
    path = HERE / f"{name}.subset.ttf"
    font.save(path)
    digits = {font["hmtx"][font.getBestCmap()[ord(d)]][0] for d in "0123456789" if ord(d) in font.getBestCmap()}
    assert len(digits) <= 1, f"{name}: digits of different widths"
    print(f"{path.name:36} {len(codepoints):4} characters {path.stat().st_size:7} bytes")
missing = [chr(c) for group in SYMBOLS for c in group if c not in covered]
print("in none of the fonts:", " ".join(missing) or "nothing")
