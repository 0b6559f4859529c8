# SPDX-License-Identifier: GPL-3.0-or-later
shear_add_test(figure_scale SOURCES test_figure_scale.c LIBRARIES shear_figures shear_static LABELS figures)
foreach(name figure figure_file figure_image)
  shear_add_test(${name} SOURCES test_${name}.c figure_fixture.c LIBRARIES shear_figures shear_static LABELS figures)
endforeach()
shear_add_test(plot SOURCES test_plot.c LIBRARIES shear_client LABELS figures)
