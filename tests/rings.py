#!/usr/bin/env python3
"""Finds rings of imports between the files of a crate, and imports of a higher floor in the core. Follows `pub use`; tests and a
module's imports from its own descendants and ancestors do not count."""
import re
import sys
from pathlib import Path

root = Path(__file__).parent.parent
FLOORS = {"equation": 0, "plant": 1, "signal": 2, "scenario": 3, "setting": 4, "axis": 5, "run": 6, "statistics": 7, "internals": 8}
PATH = r"(?:crate|self|super)(?:::\w+)+"


def paths(tree, prefix=()):
    """The paths of a tree of `use`."""
    head, brace, rest = tree.partition("{")
    if not brace:
        return [prefix + tuple(re.sub(r"\bas\s+\w+", "", tree).replace(" ", "").strip().split("::"))]
    prefix, parts, depth = prefix + tuple(head.strip().rstrip(":").split("::")), [""], 0
    for c in rest.rstrip()[:-1]:
        depth += {"{": 1, "}": -1}.get(c, 0)
        parts = parts + [""] if c == "," and depth == 0 else parts[:-1] + [parts[-1] + c]
    return [path for part in parts if part.strip() for path in paths(part.strip(), prefix)]


def check(src):
    texts, exports, uses = {}, {}, {}
    for file in src.rglob("*.rs"):
        name = tuple(part for part in file.relative_to(src).with_suffix("").parts if part not in ("lib", "main"))
        if not {"tests", "bin"} & set(name):
            text = re.sub(r'//[^\n]*|"(?:\\.|[^"\\])*"', "", file.read_text(encoding="utf-8"))
            texts[name] = re.split(r"#\[cfg\(test\)\]\s*mod \w+ \{", text)[0]
    for module, text in texts.items():
        def absolute(path):
            up = sum(part == "super" for part in path)
            rest = tuple(part for part in path if part not in ("crate", "super", "self"))
            if path[0] in ("crate", "self", "super"):
                return () + rest if path[0] == "crate" else module[: len(module) - up] + rest
            return module + rest if module + rest[:1] in texts else None
        found = [(bool(pub), absolute(p)) for pub, tree in re.findall(r"(pub(?:\([^)]*\))? )?\buse\s+([^;]+);", text) for p in paths(tree)]
        found += [(False, absolute(tuple(p.split("::")))) for p in re.findall(PATH, re.sub(r"\buse\s+[^;]+;", "", text))]
        exports[module] = {path[-1]: path for is_pub, path in found if is_pub and path}
        uses[module] = [path for is_pub, path in found if path and not is_pub]

    def home(path, depth=0):
        for k in range(len(path), -1, -1):
            if path[:k] in texts:
                there = exports[path[:k]].get(path[k]) if k < len(path) else None
                return home(there + path[k + 1:], depth + 1) if there and there != path[: k + 1] and depth < 9 else path[:k]
    edges = {m: {t for t in map(home, u) if t[: len(m)] != m and m[: len(t)] != t} for m, u in uses.items()}
    floor = lambda m: FLOORS[m[0]] if src.parent.name == "core" and m and m[0] in FLOORS else None
    bad = [f"{'/'.join(m)} imports {'/'.join(t)}, of a higher floor" for m in edges for t in edges[m]
           if None not in (floor(m), floor(t)) and floor(m) < floor(t)]
    while ends := [m for m in edges if not edges[m] & edges.keys() or not any(m in edges[other] for other in edges)]:
        edges = {m: edges[m] for m in edges if m not in ends}
    return bad + ([f"rings among {', '.join('/'.join(m) for m in sorted(edges))}"] if edges else [])


crates = [c.parent for c in root.rglob("Cargo.toml") if (c.parent / "src").is_dir() and not {"target", "fuzz"} & set(c.parts)]
found = [f"{crate.relative_to(root)}: {line}" for crate in crates for line in check(crate / "src")]
sys.exit("\n".join(found) or (0 if len(crates) > 8 else f"only {len(crates)} crates"))
