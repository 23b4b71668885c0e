#!/bin/sh
# documentation.sh DOCUMENT...: where a line <!-- FILE --> stands above a block of code, FILE must hold that block as it is.
# Run in the root of the repository.
for document; do
  awk '
    function check(  text, line) {
      while ((getline line < file) > 0) text = text line "\n"
      close(file)
      ++checked
      if (index(text, block) > 0) return
      printf "%s:%d: not what stands in %s\n", FILENAME, start, file
      failed = 1
    }
    /^```/ && inside { if (file != "") check(); file = ""; inside = 0; next }
    /^```/ { inside = 1; start = NR; block = ""; next }
    inside { block = block $0 "\n"; next }
    /^<!-- .* -->$/ { file = $2; next }
    /./ { file = "" }
    END {
      if (!checked) printf "%s: shows no code of a file\n", FILENAME
      exit failed || !checked
    }' "$document" || exit 1
done
