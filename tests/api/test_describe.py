"""`describe` and `error` from Python: what they give, and their errors."""

from motionsync_fmu import describe, error


def test_a_description_has_variables_enumerations_and_codes() -> None:
    """model/motionsync/cut_to_length/interface.py: kerf is a tunable parameter, a length, 0 at first."""
    description = describe("cuttolength", unit="m")
    kerf = description.variables["kerf"]
    assert description.name == "CutToLength"
    assert (kerf.causality, kerf.variability, kerf.type, kerf.unit, kerf.start) == (
        "parameter",
        "tunable",
        "Real",
        "m",
        "0.0",
    )
    assert "material" in kerf.description
    assert "LateMode" in [enumeration.__name__ for enumeration in description.enumerations]
    assert {16, 17} <= {code.number for code in description.codes}
    assert f"{len(description.variables)} variables" in repr(description)


def test_a_notebook_shows_the_variables_and_codes() -> None:
    page = describe("FlyingSaw")._repr_html_()
    assert '<th scope="row">gear_in_pos.execute</th><td>input</td>' in page
    assert "17118 = 0x42DE" in page
    assert "mm/s²" in page


def test_codes_are_found_by_number_and_words() -> None:
    (code,) = error(17118)
    assert (code.block, code.name, code.number_text) == ("FlyingSaw", "NOT_AHEAD", "17118 = 0x42DE")
    assert error("flyingsaw", "0x42DE") == error("must be ahead") == [code]
