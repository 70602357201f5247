#!/usr/bin/env python3
"""Every link of the documents leads to a file and a heading, the book links only to its pages and to pictures, and the paths that the first
pages name are there."""
import re
import subprocess
import sys
from pathlib import Path

root = Path(__file__).parent.parent
names = subprocess.run(["git", "ls-files", "-co", "--exclude-standard", "*.md"], cwd=root, capture_output=True, text=True, check=True).stdout
pages = {root / name: (root / name).read_text(encoding="utf-8") for name in names.split("\n") if (root / name).is_file()}
outside = {page: "".join(text.split("```")[::2]) for page, text in pages.items()}
bad, links = [], 0
for page, text in outside.items():
    for target in re.findall(r"\]\(([^)]+)\)", "".join(text.split("`")[::2])):
        if re.match(r"https://|mailto:", target):
            continue
        links += 1
        file, _, anchor = target.partition("#")
        path = (page.parent / file).resolve() if file else page
        headings = [re.sub(r"[^\w -]", "", line.lstrip("#").strip().lower()).replace(" ", "-")
                    for line in outside.get(path, "").split("\n") if line.startswith("#")]
        of_book = page.parent == root / "docs" and "/" in target and not target.startswith("../tests/snapshots/")
        if not path.exists() or anchor and anchor not in headings or of_book:
            bad.append(f"{page.relative_to(root)}: `{target}` leads nowhere")
    if page.parent == root / "docs" and page.name != "SUMMARY.md" and f"({page.name})" not in pages[root / "docs/SUMMARY.md"]:
        bad.append(f"docs/{page.name} is not in the summary")
    if page.parent == root:
        for named in re.findall(r"`((?:core|src|lab|lessons|assets|tests|docs|cli|sources)/[^` ]*)`", text):
            if not (root / re.sub(r"NEW\.\w+", "", named)).exists():
                bad.append(f"{page.name}: there is no `{named}`")
sys.exit("\n".join(bad) or (0 if links > 60 else f"only {links} links"))
