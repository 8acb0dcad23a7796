"""The lowest versions that pyproject.toml names, exactly: what the package and its tests are tried with."""

import re
import tomllib
from pathlib import Path

project = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text())["project"]
for need in [*project["dependencies"], *project["optional-dependencies"]["test"]]:
    name, lowest = re.fullmatch(r"([\w.\[\]-]+)>=([\d.]+).*", need).groups()
    print(f"{name}=={lowest}")
