#!/usr/bin/env bash
# Prints the instructions that one predict and update takes, case by case, as callgrind counts them: a number that does
# not depend on the machine's mood. Needs valgrind.
set -euo pipefail
cd "$(dirname "$0")/.."
program=$(cargo bench --bench steps --no-run --message-format=json 2>/dev/null |
  sed -n 's/.*"name":"steps".*"executable":"\([^"]*\)".*/\1/p' | tail -1)

# The instructions of some steps of a case, starting the program included.
instructions() {
  valgrind --tool=callgrind --callgrind-out-file=/dev/null "$program" "$1" "$2" 2>&1 |
    sed -n 's/.*Collected : \([0-9]*\).*/\1/p'
}

"$program" | while IFS= read -r name; do
  few=$(instructions "$name" 200)
  many=$(instructions "$name" 1200)
  printf '%6d  %s\n' $(((many - few) / 1000)) "$name"
done
