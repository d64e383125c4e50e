"""Looking at robots: frames of every engine's states (`rendering`), films, and episodes of policies (`play`).

Nothing is imported here: `crossgait.viewing.rendering` needs MuJoCo's package, films need imageio.
"""
