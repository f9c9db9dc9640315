"""What the Shifter is measured in."""

from cases.measured import Cases, Steady, Worst

CASES = Cases(
    steady=(Steady("ahead of the master", begin={"offset": 50.0, "apply": True}, holds={"error": False}),),
    worst=(Worst("an edge", ("apply",), watch=("error_id",), planned=((0,),)),),
)
