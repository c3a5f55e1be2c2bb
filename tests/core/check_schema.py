"""Holds scene files against a JSON Schema, and the schema against draft 2020-12.

usage: check_schema.py SCHEMA VALID_FOLDER INVALID_FOLDER
Exit: 0 all as expected, 1 not, 77 the module jsonschema is not installed.
"""

import json
import pathlib
import sys

try:
    from jsonschema import Draft202012Validator
except ImportError:
    print("python3-jsonschema is not installed")
    sys.exit(77)


def main():
    schema = json.loads(pathlib.Path(sys.argv[1]).read_text())
    Draft202012Validator.check_schema(schema)
    validator = Draft202012Validator(schema)
    wrong = 0
    for folder, expected in ((sys.argv[2], True), (sys.argv[3], False)):
        files = sorted(pathlib.Path(folder).glob("*.json"))
        if not files:
            print(f"{folder}: no files")
            wrong += 1
        for file in files:
            errors = list(validator.iter_errors(json.loads(file.read_text())))
            if (not errors) != expected:
                wrong += 1
                print(f"{file}: expected to be {'valid' if expected else 'invalid'}: {file.read_text()}")
                for error in errors:
                    print(f"  {error.json_path}: {error.message}")
    return 1 if wrong else 0


sys.exit(main())
