"""From the Thévenin waves at a group with laws to its efforts, by the unit that the group needs."""

from tline.unit import function, invoke


@function
def pass_laws(run, g, n, h, own):
    """Turn the waves of n samples into efforts; slabs, or pieces, are h wide, with an `own` map or not."""
    if run.network.laws.governed[g]:
        invoke(run.units.govern, (run, g, n, h, own))
    elif run.network.load_at[g] >= 0:
        invoke(run.units.circuit, (run, g, n, h, own))
    else:
        invoke(run.units.crossing, (run, g, n, h))
