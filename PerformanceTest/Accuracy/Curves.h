// Evaluates the runs of one scene for speed versus accuracy: the envelope, the order of convergence, the cost of
// accuracy. Pure functions.
#pragma once

#include <Fulcrum/PerformanceTest/Accuracy/RunRecord.h>

#include <optional>
#include <span>

namespace fulcrum::accuracy {

// Pareto front: indices of the runs that no other run beats in both cost and error, cheapest first. Without runs that
// blew up.
std::vector<size_t> Envelope(std::span<const RunRecord> runs);

// d log(error) / d log(dt): least squares over the runs with the default solver of the family Soft, without those at
// the floor, which are within a factor of two of the smallest error of these runs (but the two coarsest count in any
// case). NaN if fewer than two are left, if errors are 0, or if the coarsest is within a factor of three of the
// smallest or below a millionth: rounding errors have no order.
double SlopeOverDt(std::span<const RunRecord> runs);

// The smallest error of any run; NaN if all blew up.
double Floor(std::span<const RunRecord> runs);

// The cheapest run with an error of at most this; null if there is none.
const RunRecord* CheapestFor(std::span<const RunRecord> runs, double error);
// The cheapest run that meets all requirements; null if there is none.
const RunRecord* CheapestThatPasses(std::span<const RunRecord> runs);
// The most exact run of at most this cost, microseconds per simulated second; null if there is none.
const RunRecord* BestWithin(std::span<const RunRecord> runs, double microseconds);

const RunRecord* FindPreset(std::span<const RunRecord> runs, const std::string& preset);

}  // namespace fulcrum::accuracy
