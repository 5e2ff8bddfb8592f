#!/usr/bin/env python3
"""Plain summary of one or more JUnit files that ctest wrote: what passed, failed and was skipped, and why.

summarise_ctest.py FILE.xml...   exits 1 when a test failed or none ran. The last line reads 'N passed, N failed, N skipped'.
"""
import re
import sys
import xml.etree.ElementTree as tree


def reason_of(case):
    text = "".join(case.itertext())
    match = re.search(r"Skipped\n(.*?)\n", text + "\n", re.S)
    return match.group(1).strip() if match else "no reason given"


def main(files):
    passed, failed, skipped = 0, [], []
    for file in files:
        for case in tree.parse(file).getroot().iter("testcase"):
            name = f"{file.rsplit('/', 1)[-1].removesuffix('.xml')}: {case.get('name')}"
            status = case.get("status")
            if status == "fail":
                failed.append(name)
            elif status in ("notrun", "disabled") or case.find("skipped") is not None:
                skipped.append((name, reason_of(case)))
            else:
                passed += 1
    for name in failed:
        print(f"FAILED   {name}")
    for name, reason in skipped:
        print(f"skipped  {name}: {reason}")
    print(f"{passed} passed, {len(failed)} failed, {len(skipped)} skipped")
    return 1 if failed or passed == 0 else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
