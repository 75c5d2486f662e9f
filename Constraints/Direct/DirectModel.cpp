#include <Fulcrum/Constraints/Direct/DirectModel.h>

#include <algorithm>
#include <cmath>

namespace fulcrum {

namespace {

constexpr double kUnlimited = DirectRow::kUnlimited;

// L L^T of a positive semidefinite matrix (xx, yy, zz, xy, xz, yz), by rows. Pivots within the rounding of a matrix of
// floats are 0.
void FindRoot(const double (&m)[6], double (&l)[6]) {
    constexpr double kRounding = 0x1p-22;
    const double least = kRounding * (m[0] + m[1] + m[2]);
    const auto root = [&](double pivot) { return pivot > least ? std::sqrt(pivot) : 0.0; };
    const auto over = [](double x, double pivot) { return pivot > 0 ? x / pivot : 0.0; };
    l[0] = root(m[0]);
    l[1] = over(m[3], l[0]);
    l[2] = root(m[1] - l[1] * l[1]);
    l[3] = over(m[4], l[0]);
    l[4] = over(m[5] - l[3] * l[1], l[2]);
    l[5] = root((m[2] - l[3] * l[3]) - l[4] * l[4]);
}
// L x and L^T x
void Times(const double (&l)[6], const double* x, double* to) {
    to[0] = l[0] * x[0];
    to[1] = l[1] * x[0] + l[2] * x[1];
    to[2] = (l[3] * x[0] + l[4] * x[1]) + l[5] * x[2];
}
void TransposedTimes(const double (&l)[6], const double* x, double* to) {
    to[0] = (l[0] * x[0] + l[1] * x[1]) + l[3] * x[2];
    to[1] = l[2] * x[1] + l[4] * x[2];
    to[2] = l[5] * x[2];
}
void SymmetricTimes(const double (&m)[6], const double* x, double* to) {
    to[0] = (m[0] * x[0] + m[3] * x[1]) + m[4] * x[2];
    to[1] = (m[3] * x[0] + m[1] * x[1]) + m[5] * x[2];
    to[2] = (m[4] * x[0] + m[5] * x[1]) + m[2] * x[2];
}
double Dot3(const double* a, const double* b) { return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]; }

bool IsSamePair(const DirectRow& x, const DirectRow& y) { return x.a == y.a && x.b == y.b; }

uint32_t EndOfRun(std::span<const DirectRow> rows, uint32_t begin) {
    uint32_t end = begin + 1;
    while (end < rows.size() && IsSamePair(rows[begin], rows[end])) ++end;
    return end;
}

// Impulse of tangents that would take the velocities x and y along the patch, by the disc of `limit`: -factor (x, y).
struct Sliding {
    double x, y, length, factor;
    bool isSticking;

    Sliding(double speedX, double speedY, double d, double limit)
        : x(speedX), y(speedY), length(std::sqrt(x * x + y * y)), isSticking(length * d <= limit) {
        factor = isSticking ? d : limit / length;
    }
};

}  // namespace

std::span<const DirectEdge> DirectEdgesOf(std::span<const DirectRow> rows, ScratchArena& scratch) {
    std::span<DirectEdge> edges = scratch.Allocate<DirectEdge>(rows.size());
    size_t count = 0;
    for (uint32_t i = 0; i < rows.size(); i = EndOfRun(rows, i))
        if (rows[i].a != DirectRow::kNone && rows[i].b != DirectRow::kNone) edges[count++] = {rows[i].a, rows[i].b};
    return edges.first(count);
}

DirectModel::DirectModel(const DirectProblem& problem, const DirectPattern& pattern, double margin,
                         ScratchArena& scratch)
    : pattern_(pattern),
      hasStiffness_(!problem.stiffness.empty()),
      bodies_(scratch.Allocate<Body>(pattern.Bodies() + 1)),
      jacobians_(scratch.Allocate<Jacobian>(problem.rows.size())),
      rows_(scratch.Allocate<Row>(problem.rows.size())),
      patches_(scratch.Allocate<Patch>(problem.patches.size())),
      gradient_(scratch.Allocate<Column6>(pattern.Bodies() + 1)) {
    bodies_.back() = {};
    for (uint32_t i = 0; i < pattern.Bodies(); ++i) {
        const DirectBody& from = problem.bodies[i];
        Body& body = bodies_[pattern.PlaceOf(i)];
        body = {};
        body.residualScale = std::sqrt(from.inverseMass);
        for (int k = 0; k < 3; ++k) body.linear[k] = from.lockedAxes >> k & 1 ? 0.0 : body.residualScale;
        FindRoot(from.inverseInertia, body.angular);
        std::copy_n(from.velocity, 6, body.velocity);
    }
    for (const DirectStiffness& from : problem.stiffness) {
        Body& body = bodies_[pattern.PlaceOf(from.body)];
        // S^T G S, column by column, and S^T G w*.
        double columns[3][3], moved[3], turned[3];
        for (int k = 0; k < 3; ++k) {
            const double unit[3] = {k == 0 ? 1.0 : 0.0, k == 1 ? 1.0 : 0.0, k == 2 ? 1.0 : 0.0};
            Times(body.angular, unit, turned);
            SymmetricTimes(from.k, turned, moved);
            TransposedTimes(body.angular, moved, columns[k]);
        }
        const double g[6] = {columns[0][0], columns[1][1], columns[2][2], columns[1][0], columns[2][0], columns[2][1]};
        for (int k = 0; k < 6; ++k) body.stiffness[k] += g[k];
        SymmetricTimes(from.k, body.velocity + 3, moved);
        TransposedTimes(body.angular, moved, turned);
        for (int k = 0; k < 3; ++k) body.force[k] += turned[k];
    }

    const auto placeOf = [&](uint32_t body) {
        return body == DirectRow::kNone ? pattern.Bodies() : pattern.PlaceOf(body);
    };
    runs_ = scratch.Allocate<Run>(problem.rows.size());
    size_t runs = 0;
    for (uint32_t begin = 0; begin < problem.rows.size();) {
        const DirectRow& first = problem.rows[begin];
        const uint32_t end = EndOfRun(problem.rows, begin), a = placeOf(first.a), b = placeOf(first.b);
        const bool isOfTwo = first.a != DirectRow::kNone && first.b != DirectRow::kNone;
        const uint32_t block = isOfTwo ? pattern.BlockAt(a, b) : DirectPattern::kNone;
        isCovered_ &= !isOfTwo || block != DirectPattern::kNone;
        runs_[runs++] = {begin, end, a, b, block, a < b};
        const auto scaled = [](const Body& body, const double(&j)[6], double& speed) {
            Column6 result;
            for (int k = 0; k < 3; ++k) result[k] = body.linear[k] * j[k];
            TransposedTimes(body.angular, j + 3, result.v + 3);
            speed += Dot3(j, body.velocity) + Dot3(j + 3, body.velocity + 3);
            return result;
        };
        for (uint32_t i = begin; i < end; ++i) {
            const DirectRow& from = problem.rows[i];
            double c = from.c;
            jacobians_[i].a = scaled(bodies_[a], from.ja, c);
            jacobians_[i].b = scaled(bodies_[b], from.jb, c);
            // What separates by less than the margin counts as touching: else bodies would fall freely for a whole
            // step.
            const bool isOneSided = from.lo == 0 || from.hi == 0;
            rows_[i] = {.c = c,
                        .d = from.inverseGamma,
                        .lo = from.lo,
                        .hi = from.hi,
                        .speed = 0,
                        .stepSpeed = 0,
                        .impulse = from.impulse,
                        .margin = isOneSided ? from.inverseGamma * margin : 0,
                        .last = from.impulse,
                        .wasLimited = false};
        }
        begin = end;
    }
    runs_ = runs_.first(runs);

    for (size_t i = 0; i < patches_.size(); ++i) {
        const DirectPatch& from = problem.patches[i];
        Patch& patch = patches_[i];
        const uint32_t tangent = from.firstNormal + from.normals;
        const auto run = std::upper_bound(runs_.begin(), runs_.end(), tangent,
                                          [](uint32_t row, const Run& other) { return row < other.end; });
        patch = {.firstNormal = from.firstNormal,
                 .tangent = tangent,
                 .run = static_cast<uint32_t>(run - runs_.begin()),
                 .friction = from.friction,
                 .twistRadius = from.twistRadius,
                 .d = problem.rows[tangent].inverseGamma,
                 .limit = 0,
                 .limitBefore = 0,
                 .wasSliding = false};
        double sum = 0;
        for (uint32_t r = from.firstNormal; r < tangent; ++r) sum += std::max(rows_[r].impulse, 0.0);
        for (uint32_t r = from.firstNormal; r < tangent + 3; ++r) {
            Row& row = rows_[r];
            if (row.d > 0 && (problem.isAtRest || r >= tangent)) row.c -= row.impulse / row.d;
            if (r >= tangent) row.margin = 0;
            if (r == tangent || r == tangent + 1) row.d = 0;
        }
        SetLimit(patch, sum > 0 ? from.friction * sum : kUnlimited);
        const double x = rows_[tangent].last, y = rows_[tangent + 1].last,
                     holding = DirectPatch::kHolding * patch.limit;
        patch.wasSliding = !(x * x + y * y <= holding * holding);
    }
    for (Row& row : rows_) {
        const double rest = row.hi < kUnlimited && row.lo > -kUnlimited ? (1 - DirectPatch::kHolding) * row.hi : 0.0;
        row.wasLimited = !(row.last > row.lo + rest && row.last < row.hi - rest);
    }
}

bool DirectModel::HasLast() const {
    return std::ranges::any_of(patches_, [](const Patch& patch) { return patch.limit < kUnlimited; });
}

void DirectModel::SetLimit(Patch& patch, double limit) {
    patch.limitBefore = patch.limit;
    patch.limit = limit;
    Row& twist = rows_[patch.tangent + 2];
    twist.hi = patch.twistRadius > 0 ? limit * patch.twistRadius : 0.0;
    twist.lo = -twist.hi;
}

void DirectModel::RenewLimits() {
    for (Patch& patch : patches_) {
        double sum = 0;
        for (uint32_t r = patch.firstNormal; r < patch.tangent; ++r) sum += rows_[r].impulse;
        SetLimit(patch, patch.friction * sum);
    }
}
void DirectModel::RestoreLimits() {
    for (Patch& patch : patches_) SetLimit(patch, patch.limitBefore);
}

void DirectModel::Start(std::span<Column6> y) const {
    std::fill(y.begin(), y.end(), Column6{});
    for (const Run& run : runs_)
        for (uint32_t r = run.begin; r < run.end; ++r) {
            const double impulse = rows_[r].impulse;
            (Lanes6(y[run.a]) + Lanes6(jacobians_[r].a) * impulse).StoreTo(y[run.a]);
            (Lanes6(y[run.b]) + Lanes6(jacobians_[r].b) * impulse).StoreTo(y[run.b]);
        }
}

void DirectModel::FindSpeeds(std::span<const Column6> y) {
    for (const Run& run : runs_) {
        const Lanes6 ya(y[run.a]), yb(y[run.b]);
        for (uint32_t r = run.begin; r < run.end; ++r)
            rows_[r].speed = rows_[r].c + Sum(Lanes6(jacobians_[r].a) * ya + Lanes6(jacobians_[r].b) * yb);
    }
}
void DirectModel::FindStepSpeeds(std::span<const Column6> step) {
    for (const Run& run : runs_) {
        const Lanes6 stepA(step[run.a]), stepB(step[run.b]);
        for (uint32_t r = run.begin; r < run.end; ++r)
            rows_[r].stepSpeed = Sum(Lanes6(jacobians_[r].a) * stepA + Lanes6(jacobians_[r].b) * stepB);
    }
}

void DirectModel::FindGradientOfMasses(std::span<const Column6> y) {
    std::copy_n(y.begin(), gradient_.size(), gradient_.begin());
    if (!hasStiffness_) return;
    for (uint32_t i = 0; i < pattern_.Bodies(); ++i) {
        double moved[3];
        SymmetricTimes(bodies_[i].stiffness, y[i].v + 3, moved);
        for (int k = 0; k < 3; ++k) gradient_[i][3 + k] += moved[k] + bodies_[i].force[k];
    }
}

double DirectModel::Evaluate(std::span<const Column6> y) {
    FindSpeeds(y);
    for (Row& row : rows_) {
        const double wanted = -row.d * row.speed;
        row.impulse = !trustsLast_ ? std::min(std::max(wanted, row.lo), row.hi) : row.wasLimited ? row.last : wanted;
    }
    for (const Patch& patch : patches_) {
        Row &first = rows_[patch.tangent], &second = rows_[patch.tangent + 1];
        if (trustsLast_) {
            for (Row* row : {&first, &second}) row->impulse = patch.wasSliding ? row->last : -patch.d * row->speed;
            continue;
        }
        const Sliding sliding(first.speed, second.speed, patch.d, patch.limit);
        first.impulse = -sliding.factor * first.speed;
        second.impulse = -sliding.factor * second.speed;
    }

    FindGradientOfMasses(y);
    for (const Run& run : runs_) {
        Lanes6 ga(gradient_[run.a]), gb(gradient_[run.b]);
        for (uint32_t r = run.begin; r < run.end; ++r) {
            ga = ga - Lanes6(jacobians_[r].a) * rows_[r].impulse;
            gb = gb - Lanes6(jacobians_[r].b) * rows_[r].impulse;
        }
        ga.StoreTo(gradient_[run.a]);
        gb.StoreTo(gradient_[run.b]);
    }
    double residual = 0;
    for (uint32_t i = 0; i < pattern_.Bodies(); ++i) {
        const double* g = gradient_[i].v;
        const double square = std::max(Dot3(g, g), Dot3(g + 3, g + 3));
        residual = std::max(residual, bodies_[i].residualScale * std::sqrt(square));
        if (!(square < kUnlimited)) return kUnlimited;
    }
    return residual;
}

void DirectModel::AssembleMasses(const BlockMatrix& matrix) const {
    std::fill(matrix.diagonal.begin(), matrix.diagonal.end(), Block6{});
    std::fill(matrix.lower.begin(), matrix.lower.end(), Block6{});
    for (uint32_t i = 0; i < pattern_.Bodies(); ++i) {
        Block6& block = matrix.diagonal[i];
        for (int k = 0; k < 6; ++k) block.columns[k][k] = 1;
        if (!hasStiffness_) continue;
        const double(&g)[6] = bodies_[i].stiffness;
        for (int k = 0; k < 3; ++k) block.columns[3 + k][3 + k] += g[k];
        block.columns[3][4] = block.columns[4][3] = g[3];
        block.columns[3][5] = block.columns[5][3] = g[4];
        block.columns[4][5] = block.columns[5][4] = g[5];
    }
}

void DirectModel::AddToMatrix(DirectProducts& products, const Run& run, const BlockMatrix& matrix) const {
    const auto diagonal = [&](uint32_t place) { return place < pattern_.Bodies() ? &matrix.diagonal[place] : nullptr; };
    products.AddTo(diagonal(run.a), diagonal(run.b),
                   run.block != DirectPattern::kNone ? &matrix.lower[run.block] : nullptr, run.isAFirst);
}

void DirectModel::Assemble(const BlockMatrix& matrix, bool withMargin) const {
    AssembleMasses(matrix);
    DirectProducts products;
    for (const Run& run : runs_) {
        for (uint32_t r = run.begin; r < run.end; ++r) {
            const Row& row = rows_[r];
            const double wanted = -row.d * row.speed, margin = withMargin ? row.margin : 0;
            const bool isLimited =
                trustsLast_ ? row.wasLimited : !(wanted > row.lo - margin && wanted < row.hi + margin);
            if (!(row.d > 0) || isLimited) continue;
            if (products.IsFull()) AddToMatrix(products, run, matrix);
            products.Add(jacobians_[r].a, jacobians_[r].b, row.d);
        }
        AddToMatrix(products, run, matrix);
    }
    for (const Patch& patch : patches_) {
        const Row &first = rows_[patch.tangent], &second = rows_[patch.tangent + 1];
        const Jacobian &j1 = jacobians_[patch.tangent], &j2 = jacobians_[patch.tangent + 1];
        const Sliding sliding(first.speed, second.speed, patch.d, patch.limit);
        if (trustsLast_ ? !patch.wasSliding : sliding.isSticking) {
            products.Add(j1.a, j1.b, patch.d);
            products.Add(j2.a, j2.b, patch.d);
        } else if (!trustsLast_) {
            // Only across the motion: along it the impulse is constant.
            const double alongX = first.speed / sliding.length, alongY = second.speed / sliding.length;
            const auto across = [&](const Column6& x, const Column6& y) {
                Column6 result;
                (Lanes6(y) * alongX - Lanes6(x) * alongY).StoreTo(result);
                return result;
            };
            products.Add(across(j1.a, j2.a), across(j1.b, j2.b), sliding.factor);
        }
        AddToMatrix(products, runs_[patch.run], matrix);
    }
}

// Derivative along the step, at this factor of it: `start` and `quadratic` are those of masses and stiffness.
DirectModel::Slope DirectModel::SlopeAt(double factor, double start, double quadratic) const {
    Slope slope{start + factor * quadratic, quadratic};
    for (const Row& row : rows_) {
        const double wanted = -row.d * (row.speed + factor * row.stepSpeed);
        slope.value -= std::min(std::max(wanted, row.lo), row.hi) * row.stepSpeed;
        slope.change += wanted > row.lo && wanted < row.hi ? row.d * row.stepSpeed * row.stepSpeed : 0.0;
    }
    for (const Patch& patch : patches_) {
        const Row &first = rows_[patch.tangent], &second = rows_[patch.tangent + 1];
        const Sliding sliding(first.speed + factor * first.stepSpeed, second.speed + factor * second.stepSpeed, patch.d,
                              patch.limit);
        slope.value += sliding.factor * (sliding.x * first.stepSpeed + sliding.y * second.stepSpeed);
        if (sliding.isSticking) {
            slope.change += patch.d * (first.stepSpeed * first.stepSpeed + second.stepSpeed * second.stepSpeed);
        } else {
            const double across = (sliding.x * second.stepSpeed - sliding.y * first.stepSpeed) / sliding.length;
            slope.change += sliding.factor * across * across;
        }
    }
    return slope;
}

double DirectModel::SearchAlong(std::span<const Column6> y, std::span<const Column6> step) {
    // Relative to the slope at the beginning. The slope is piecewise linear but for sliding patches: Newton steps on it
    // end at its zero once they are on the right piece, and most steps of the solver are on that at once.
    constexpr double kFlat = 1e-3;
    constexpr int kMostSteps = 50;  // halving alone exhausts a double's digits
    FindStepSpeeds(step);
    double first = 0, start = 0, quadratic = 0;
    for (uint32_t i = 0; i < pattern_.Bodies(); ++i) {
        first += Dot(gradient_[i], step[i]);
        start += Dot(y[i], step[i]);
        quadratic += Dot(step[i], step[i]);
        if (!hasStiffness_) continue;
        const double *turn = y[i].v + 3, *stepTurn = step[i].v + 3;
        double moved[3];
        SymmetricTimes(bodies_[i].stiffness, stepTurn, moved);
        start += Dot3(moved, turn) + Dot3(bodies_[i].force, stepTurn);
        quadratic += Dot3(moved, stepTurn);
    }
    double factor = 1, low = 0, high = kUnlimited;
    for (int i = 0; i < kMostSteps; ++i) {
        const Slope slope = SlopeAt(factor, start, quadratic);
        if (!(std::abs(slope.value) > kFlat * std::abs(first))) break;
        (slope.value > 0 ? high : low) = factor;
        const double next = factor - slope.value / slope.change;
        if (next > low && next < high) factor = next;
        else factor = high < kUnlimited ? 0.5 * (low + high) : 2 * factor;
    }
    return factor;
}

void DirectModel::Store(std::span<const Column6> y, std::span<DirectVelocity> velocities,
                        std::span<DirectRow> rows) const {
    for (uint32_t i = 0; i < pattern_.Bodies(); ++i) {
        const uint32_t place = pattern_.PlaceOf(i);
        const Body& body = bodies_[place];
        double turn[3];
        Times(body.angular, y[place].v + 3, turn);
        for (int k = 0; k < 3; ++k) {
            velocities[i].v[k] = body.velocity[k] + body.linear[k] * y[place][k];
            velocities[i].v[3 + k] = body.velocity[3 + k] + turn[k];
        }
    }
    for (size_t r = 0; r < rows.size(); ++r) rows[r].impulse = rows_[r].impulse;
}

}  // namespace fulcrum
