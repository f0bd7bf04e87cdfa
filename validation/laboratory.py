"""Writes synthetic raw data of a laboratory: images and forces of a calibration sample, and of a made part.

`python -m validation.laboratory lab` writes the calibration sample, and the specification of a surface
without its material. `python -m validation.laboratory lab --part DIR` makes the design of a result folder,
with errors, and measures it.
"""

from __future__ import annotations

import shutil
from pathlib import Path

import click

import metafem as mf
from validation.scenes.laboratory import Series, calibration_tests, part_test

# The specification of a surface without its material.
WANTED = Path(__file__).with_name("wanted.toml")


@click.command(help=__doc__.partition("\n\n")[2])
@click.argument("folder", type=click.Path(path_type=Path))
@click.option(
    "--part", type=click.Path(path_type=Path, exists=True), help="Result folder of the part's design."
)
def main(folder: Path, part: Path | None) -> None:
    """Write the raw data."""
    if part is None:
        write(folder / "sample", calibration_tests())
        shutil.copyfile(WANTED, folder / "wanted.toml")
        click.echo(f"wrote {folder / 'sample'} and {folder / 'wanted.toml'}")
        return
    write(folder / "part", [part_test(mf.load(part).surface)])
    click.echo(f"wrote {folder / 'part'}")


def write(folder: Path, tests: list[Series]) -> None:
    """Write tests as TIFF files, with pixels of 10 um, and a table of the forces."""
    import tifffile

    folder.mkdir(parents=True, exist_ok=True)
    rows = ["image,sheared_image,test,load_mN,friction_force_mN"]
    for number, test in enumerate(tests, 1):
        for k, (load, force) in enumerate(zip(test.load, test.friction_force, strict=True), 1):
            names = [f"test{number}_{k}{state}.tif" for state in ("", "_sheared")]
            for name, sheared in zip(names, (False, True), strict=True):
                tifffile.imwrite(folder / name, test.image(k - 1, sheared), compression="zlib")
            rows.append(f"{names[0]},{names[1]},test {number},{1e3 * load:.2f},{1e3 * force:.2f}")
    (folder / "forces.csv").write_text("\n".join(rows) + "\n")


if __name__ == "__main__":
    main()
