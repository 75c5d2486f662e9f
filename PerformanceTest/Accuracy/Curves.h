// What the runs of one scene say of speed against accuracy: the envelope, the order of convergence, costs of accuracy.
// Pure functions.
#pragma once

#include <Fulcrum/PerformanceTest/Accuracy/RunRecord.h>

#include <optional>
#include <span>

namespace fulcrum::accuracy {

// Indices of the runs that no other one beats in both cost and error, cheapest first. Runs that blew up are not among
// them.
std::vector<size_t> Envelope(std::span<const RunRecord> runs);

// d log(error) / d log(dt): least squares over the runs with the default solver of the family Soft, without those at
// the floor, which are within a factor of two of the smallest error of these runs (but the two coarsest count in any
// case). NaN where fewer than two are left, where errors are 0, or where the coarsest is within a factor of three of
// the smallest or below a millionth: what is rounding has no order.
double SlopeOverDt(std::span<const RunRecord> runs);

// The smallest error of any run; NaN where all blew up.
double Floor(std::span<const RunRecord> runs);

// The cheapest run with an error of at most this; null where there is none.
const RunRecord* CheapestFor(std::span<const RunRecord> runs, double error);
// The cheapest run that fails no gate; null where there is none.
const RunRecord* CheapestThatPasses(std::span<const RunRecord> runs);
// The most exact run of at most this cost, microseconds per simulated second; null where there is none.
const RunRecord* BestWithin(std::span<const RunRecord> runs, double microseconds);

const RunRecord* FindPreset(std::span<const RunRecord> runs, const std::string& preset);

}  // namespace fulcrum::accuracy
