"""Walks the same in every engine, side by side: how far they lie apart, and what came first apart."""

import crossgait

compared = crossgait.compare("trot", terrain="rough", seed=3, seconds=2)
print(compared)
for pair in compared.pairs:
    print(f"{pair['a']} and {pair['b']}: {pair['max_position_difference_m']:.2g} m apart at most")
