"""The page of the FlyingSaw, or a description, says what has become of each name in the source's structures."""

import re

from motionsync.blocks import BLOCKS
from motionsync.flying_saw.block import FlyingSaw
from motionsync_fmu.interface.block_folder import block_file
from motionsync_fmu.interface.variables import variables

# TS5055, 12.1 and 12.3: inputs and outputs of MC_GearInVelo and MC_GearInPos, MC_FlyingSawCharacValues, ST_SyncMode
EXTREMES = [f"f{axis}At{what}{side}" for side in ("Min", "Max") for axis, what in [("MPos", "SPos"), ("MPos", "SVelo")]]
CHARACTERISTICS = [
    *("fMasterVeloNom", "fMasterPosStart", "fMasterPosEnd"),
    *(
        f"fSlave{quantity}{end}"
        for quantity in ("Pos", "Velo", "Acc", "Jerk")
        for end in ("Start", "End", "Min", "Max")
    ),
    *EXTREMES,
    *(f"f{what}AtSAcc{side}" for what in ("MPos", "SVelo") for side in ("Min", "Max")),
    *("fSlaveDynMomMin", "fSlaveDynMomMax", "fSlaveVeloMean", "fSlaveAccEff"),
    *("CamTableID", "NumberOfRows", "NumberOfColumns", "TableType", "Periodic", "reserved", "reserved2"),
]
CHECKS = [
    *("MINPOS", "MAXPOS", "MAXVELO", "MAXACC", "MAXDEC", "MAXJERK", "OVERSHOOTPOS", "UNDERSHOOTPOS"),
    *("OVERSHOOTVELO", "UNDERSHOOTVELO", "OVERSHOOTVELOZERO", "UNDERSHOOTVELOZERO"),
]
OPERATIONS = [
    *("ROLLBACKLOCK", "INSTANTSTOPONROLLBACK", "PREFERCONSTVELO", "IGNOREMASTERACC", "IGNORESLAVEACC"),
    "DETAILEDERRORCODES",
]
NAMES = [
    *CHARACTERISTICS,
    *(f"GEARINSYNC_CHECKMASK_{name}" for name in CHECKS),
    *(f"GEARINSYNC_OPMASK_{name}" for name in OPERATIONS),
    *("GEARINSYNCMODE_TIMEBASED", "BufferMode", "Options", "nAxisState", "SlaveAxisId"),
]


def test_each_name_of_the_source_is_found() -> None:
    texts = [block_file(BLOCKS["FlyingSaw"], "README.md").read_text("utf-8")]
    texts += [v.declaration.description for v in variables(FlyingSaw())]
    words = {word for text in texts for word in re.findall(r"\w+", text)}
    assert [name for name in NAMES if name not in words] == []
