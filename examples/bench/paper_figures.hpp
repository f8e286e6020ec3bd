// What the paper reports in its section Experiments, as data: table and row are named at each.
#pragma once

#include <cstring>
#include <optional>

namespace packcell_programs::paper {

// Bins that each column of Table (a) stands for, and sets of Table (b).
constexpr int kRandomBins = 1000;
constexpr int kFullSets = 3000;

// The scenarios of both tables, in their order.
constexpr const char *kScenarios[] = {"S-R1A1",   "S-R5A1",   "S-R5A3",
                                      "D-R2A2O2", "D-R5A2O2", "D-R5A3O1"};

// Table (a), "Performance on Random instances"; [0] without, [1] with rotation.
struct RandomColumns {
    const char *scenario;
    double utilization[2];  // row "Mean Utilization (%)"
    double packed[2];       // row "Total Packed Items"
    double steps[2];        // row "Total Packing Steps"; with one robot the same as packed items
};
constexpr RandomColumns kRandom[] = {
    {"S-R1A1", {78.88, 85.17}, {8715, 9422}, {8715, 9422}},
    {"S-R5A1", {86.45, 92.38}, {9559, 10229}, {9559, 10229}},
    {"S-R5A3", {94.77, 98.21}, {10488, 10863}, {10488, 10863}},
    {"D-R2A2O2", {85.94, 91.57}, {9507, 10127}, {5438, 5706}},
    {"D-R5A2O2", {91.99, 96.46}, {10179, 10661}, {6128, 6333}},
    {"D-R5A3O1", {95.86, 98.59}, {10602, 10905}, {5787, 5893}},
};

// Table (b), "Performance on 100% set with and without repacking"; [0] without, [1] with it.
struct FullColumns {
    const char *scenario;
    double utilization[2];  // row "Mean Utilization (%)"
    double full_bins[2];    // row "Num. of Full Bins"
    double packed[2];       // row "Mean Num. of Packed Items"
    double steps[2];        // row "Mean Num. of Packing Steps"; one robot: as packed items
    double repacked;        // row "Mean Num. of Repacking Items", with repacking
    double repack_steps;    // row "Mean Num. of Steps including Repacking"
    double repack_seconds;  // row "Mean Taken Time (s) for Repacking Solution"
};
constexpr FullColumns kFull[] = {
    {"S-R1A1", {81.52, 100}, {684, 3000}, {6.85, 8.17}, {6.85, 8.17}, 2.42, 1.00, 2.55},
    {"S-R5A1", {95.54, 100}, {2213, 3000}, {7.85, 8.17}, {7.85, 8.17}, 0.39, 0.27, 1.43},
    {"S-R5A3", {97.67, 100}, {2395, 3000}, {7.97, 8.17}, {7.97, 8.17}, 0.30, 0.21, 0.90},
    {"D-R2A2O2", {86.98, 100}, {865, 3000}, {7.44, 8.17}, {4.16, 4.34}, 1.90, 0.80, 2.82},
    {"D-R5A2O2", {96.49, 100}, {1999, 3000}, {7.84, 8.17}, {4.40, 4.34}, 0.52, 0.34, 1.33},
    {"D-R5A3O1", {96.53, 100}, {2240, 3000}, {7.91, 8.17}, {4.23, 4.34}, 0.39, 0.26, 0.79},
};

// Text of "Test with Random Instances": utilisation in % with rotation and one second a step for
// repacking.
struct OneSecond {
    const char *scenario;
    double utilization;
};
constexpr OneSecond kOneSecond[] = {
    {"S-R1A1", 98.01}, {"S-R5A1", 99.20}, {"D-R2A2O2", 99.03}, {"D-R5A2O2", 99.67}};

// The comparison with other methods: utilisation in %, online, without rotation and repacking.
struct Compared {
    const char *bin;
    const char *method;
    double utilization;
};
constexpr Compared kComparison[] = {
    {"4x4", "Deep-Pack", 94.87},    {"4x4", "BERM", 97.23},        {"4x4", "the paper's", 98.23},
    {"5x5", "ShelfNextFit", 75.80}, {"5x5", "Skyline", 85.33},     {"5x5", "Deep-Pack", 91.48},
    {"5x5", "BERM", 94.30},         {"5x5", "the paper's", 96.58},
};

// Table "Planning and Execution Time in Single- and Dual-Arms", in seconds; [0] without, [1] with
// repacking. Row by row: planning a step, its motion and its execution, and a whole episode.
struct MakespanColumns {
    const char *scenario;
    double task_planning[2];
    double motion_planning[2];
    double execution[2];
    double makespan[2];
};
constexpr MakespanColumns kMakespan[] = {
    {"S-R5A3", {0.71, 0.76}, {0.73, 0.77}, {15.50, 15.93}, {124.48, 130.98}},
    {"D-R5A3O1", {0.77, 0.85}, {1.46, 1.60}, {21.22, 22.39}, {94.29, 100.12}},
};

// The column of a scenario; nullptr where the paper has none.
template <typename Columns, size_t Count>
const Columns *find(const Columns (&table)[Count], const char *scenario) {
    for (const Columns &columns : table) {
        if (std::strcmp(columns.scenario, scenario) == 0) return &columns;
    }
    return nullptr;
}

}  // namespace packcell_programs::paper
