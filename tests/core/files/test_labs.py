"""Tables as spreadsheets, testing machines and programs for images write them are read, or refused."""

import pytest

import metafem as mf
from metafem import files

# The load is 950.5 and 1234 mN, and the area .41 and .512 mm^2.
TABLES = {
    "Excel, German": b"load_mN;area_mm2\r\n950,5;0,41\r\n1234;0,512\r\n",
    "Excel, French": "load [mN];area [mm²]\r\n950,5;0,41\r\n1234;0,512\r\n".encode("cp1252"),
    "Excel, US, CSV UTF-8": "\ufeffload_mN,area_mm²\r\n950.5,0.41\r\n1234,0.512\r\n".encode(),
    "Excel, Unicode text": "load (mN)\tarea (mm²)\r\n950,5\t0,41\r\n1234\t0,512\r\n".encode("utf-16"),
    "Excel, big-endian": b"\xfe\xff" + "load (mN)\tarea (mm²)\n950.5\t.41\n1234\t.512\n".encode("utf-16-be"),
    "Excel, with its separator": b"sep=;\r\nload_mN;area_mm2\r\n950,5;0,41\r\n1234;0,512\r\n",
    "Excel, an empty column": b"load_mN,area_mm2,\r\n950.5,0.41,\r\n1234,0.512,\r\n",
    "Excel, German, three empty columns": b"load_mN;area_mm2;;;\r\n950,5;0,41;;;\r\n1234;0,512;;;\r\n",
    "Excel, French, a time": "load (mN);Durée (s);area (mm²)\n950,5;3,2;0,41\n1234;3;0,512\n".encode(),
    "LibreOffice, quoted": b'"load_mN","area_mm2"\n"950.5","0.41"\n"1234","0.512"\n',
    "LibreOffice, German": b'load_mN,area_mm2\n"950,5","0,41"\n1234,"0,512"\n',
    "a trailing sign in each row": b"load_mN;area_mm2\n950,5;0,41;\n1234;0,512;\n",
    "a preamble": b"Sample 7, of June\nOperator: me\n\nload_mN,area_mm2\n950.5,0.41\n1234,0.512\n",
    "Instron, units below": b'"Results Table 1"\n\n"Time","Load","Contact area"\n"(s)","(mN)","(mm^2)"\n'
    b'"0.0","950.5","0.41"\n"0.1","1234.0","0.512"\n',
    "Zwick, units below": "Prüfer;Müller\n\nLoad;Area\nmN;mm²\n950,5;0,41\n1234,0;0,512\n".encode("cp1252"),
    "ImageJ, an index": b" ,Area [mm^2],Mean,Load [mN]\n1,0.41,12,950.5\n2,0.512,13,1234\n",
    "Micro-Manager, comments": b"# {'Exposure-ms': 10}\nload_mN\tarea_mm2\n950.5\t0.41\n1234\t.512\n",
    "a German name": (
        "Kraft [mN];Kontaktfläche [mm²]\n950,5;0,41\n1234;0,512\n".encode("cp1252"),
        {"load": "Kraft [mN]", "area": "Kontaktfläche [mm²]"},
    ),
    "LabVIEW, no units": (
        b"LabVIEW Measurement\t\nWriter_Version\t2\n***End_of_Header***\t\nX_Value\tUntitled\tUntitled 1\n"
        b"0.0\t950.5\t0.41\n0.1\t1234.0\t0.512\n",
        {"load_mN": "Untitled", "area_mm2": "Untitled 1"},
    ),
    "Zwick, its own names": (
        b"Standardkraft;Flaeche\nmN;mm^2\n950,5;0,41\n1234;0,512\n",
        {"load": "Standardkraft", "area": "Flaeche"},
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", TABLES)
def test_a_table_of_a_lab_is_read(name, tmp_path):
    content, columns = TABLES[name] if isinstance(TABLES[name], tuple) else (TABLES[name], {})
    (tmp_path / "a.csv").write_bytes(content)
    data = files.read_calibration([tmp_path / "a.csv"], columns=columns)[0]
    assert data["load"].tolist() == [0.9505, 1.234]
    assert data["area"].tolist() == pytest.approx([0.41, 0.512], rel=1e-15)


# Tables that can be read in two ways or name no column, with what the message holds.
REFUSED = {
    "load_mN;area_mm2\n1.234;0,512\n950,5;0,41\n": ("1.234", "950,5", "decimal signs"),
    "load_mN;area_mm2\n1.234;2.512\n": ("line 2", "1.234", "1234"),
    "load_mN\tarea_mm2\n1,234,567\t2\n": ("line 2", "1,234,567"),
    "load_mN,area_mm2\n950,5,0,41\n": ("line 2", "4 entries", "semicolons"),
    "load_mN;area_mm2\n1 234,5;0,41\n": ("line 2", "1 234,5"),
    "Standardkraft [N];Standardweg [mm]\n1,5;0,41\n": ('--column load="Standardkraft [N]"',),
    "Force (N),area_mm2\n1,2\n": ('--column load="Force (N)"',),
    "load,area_mm2\n1,2\n": ("load", "unit", "load_mN"),
    "load_Mm,area_mm2\n1,2\n": ("load_Mm", "unknown"),
}


@pytest.mark.parametrize("content", REFUSED)
def test_a_table_that_is_not_clear_is_refused(content, tmp_path):
    (tmp_path / "a.csv").write_text(content, "utf-8")
    with pytest.raises(mf.InvalidInput) as error:
        files.read_calibration([tmp_path / "a.csv"])
    assert "a.csv" in str(error.value)
    for words in REFUSED[content]:
        assert words in str(error.value)


def test_a_column_that_is_not_there_or_has_no_such_name_is_refused(tmp_path):
    (tmp_path / "a.csv").write_text("load_mN,area_mm2\n1,2\n", "utf-8")
    for columns in ({"load": "Kraft"}, {"force": "load_mN"}):
        with pytest.raises(mf.InvalidInput, match="--column"):
            files.read_table(tmp_path / "a.csv", columns)


def test_a_law_is_read_as_a_target(tmp_path):
    path = tmp_path / "law.csv"
    path.write_text("load_mN,friction_force_N,weight\n136,0.24344,1\n272,0.6086,2\n")
    target = mf.read_law(path, mf.Material(1.36), mf.Friction(0.358, 0.85))
    assert target.rescaled_friction.tolist() == pytest.approx([0.8, 2.0])
    assert target.weight.tolist() == [1.0, 2.0]
    for given in ((), (mf.Material(1.36),)):
        with pytest.raises(mf.InvalidInput, match=("material", "friction")[len(given)]):
            mf.read_law(path, *given)
