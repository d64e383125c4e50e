#!/usr/bin/env bash
# What scripts/check-commit-message lets pass and what it refuses: check_commit_message_test.sh SCRIPT
set -uo pipefail
script=$1 failed=0
message=$(mktemp)
trap 'rm -f "$message"' EXIT

# expect CODE TEXT: the script's exit code for a message.
expect() {
  printf '%b' "$2" >"$message"
  local code=0
  "$script" "$message" 2>/dev/null || code=$?
  [[ $code -eq $1 ]] || { echo "expected exit code $1, found $code for: $2" && failed=1; }
}

seventy_two=$(printf 'x%.0s' {1..72})
expect 0 "Read a robot once per command\n"
expect 0 "$seventy_two\n\nWhy it was done.\n"
expect 1 "${seventy_two}x\n"
expect 1 "Read a robot once.\n"
expect 1 "A subject\nthat goes on\n"
expect 1 "\nA body without a subject\n"
expect 1 ""
expect 0 "# a comment of git\nA subject\n\nA body\n# another\n"
expect 0 "Merge branch 'x' into main, with a subject that git wrote and that is longer than 72 characters\n"
"$script" 2>/dev/null
[[ $? -eq 2 ]] || { echo "expected exit code 2 without a file" && failed=1; }
exit $failed
