"""Walks two seconds in one engine and says how it went."""

import crossgait

walked = crossgait.walk("trot", engine=crossgait.available_engines()[0], terrain="rough", seconds=2, trace=True)
print(walked)
print(f"{walked.mean_speed_mps:.3f} m/s; highest {walked.trace['p_WB.z'].max():.3f} m")
walked.trace.to_csv("walk.csv")  # every control step; walked.plot() draws it
