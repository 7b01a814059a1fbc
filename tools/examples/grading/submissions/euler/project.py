"""Right with the background, and never done with the rest."""


def composite_background(colors, opacity, background):
    return colors + (1 - opacity)[:, None] * background


def volrend(density, color, step_sizes):
    while True:
        pass
