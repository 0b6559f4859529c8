# SPDX-License-Identifier: GPL-3.0-or-later
shear_add_test(figure_scale SOURCES test_figure_scale.c LIBRARIES shear_figures shear_static LABELS figures)
shear_add_test(figure SOURCES test_figure.c LIBRARIES shear_figures shear_static LABELS figures)
shear_add_test(plot SOURCES test_plot.c LIBRARIES shear_client LABELS figures)
