# SPDX-License-Identifier: GPL-3.0-or-later
shear_add_test(figure_scale SOURCES test_figure_scale.c LIBRARIES shear_figures shear_static LABELS figures)
shear_add_test(figure SOURCES test_figure.c LIBRARIES shear_figures shear_static LABELS figures)

# shearctl is a program, not a library: its helpers are compiled in.
shear_add_test(plot
  SOURCES test_plot.c ${PROJECT_SOURCE_DIR}/client/plot/array.c ${PROJECT_SOURCE_DIR}/client/plot/text.c
          ${PROJECT_SOURCE_DIR}/client/plot/catalog.c
  LIBRARIES shear_figures shear_static LABELS figures)
target_include_directories(test_plot PRIVATE ${PROJECT_SOURCE_DIR}/client)
