/* SPDX-License-Identifier: GPL-3.0-or-later */
/* list.h: declarations of all experiments. */
#pragma once

#include "engine/experiment.h"

extern const experiment experiment_noise;
extern const experiment experiment_images;
extern const experiment experiment_single;
extern const experiment experiment_pixels;
extern const experiment experiment_overall;
extern const experiment experiment_shot;
extern const experiment experiment_bias;
extern const experiment experiment_errors;
extern const experiment experiment_efficiency;
extern const experiment experiment_survey;
extern const experiment experiment_precision;
extern const experiment experiment_narrow;
extern const experiment experiment_selection;
