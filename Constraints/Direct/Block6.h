// Six doubles, and blocks of 6x6 of them, as the direct solver computes with them: columns of which all elements are
// computed at once, and sums in the order in which they are written, so that every compiler and every width gives the
// same bits. Plain data and free functions.
#pragma once

#include <Fulcrum/Math/WideDouble.h>

#include <cstring>

namespace fulcrum {

struct alignas(16) Column6 {
    double v[6];

    double& operator[](int i) { return v[i]; }
    double operator[](int i) const { return v[i]; }
};
// By columns. A factored block of the diagonal has its factor at and below the diagonal, with the reciprocals of the
// diagonal's elements.
struct Block6 {
    Column6 columns[6];
};

// A column in registers.
struct Lanes6 {
    typedef double Pair __attribute__((vector_size(16)));
    WideDouble::Double head;
    Pair tail;

    Lanes6() = default;
    Lanes6(const WideDouble::Double& first, const Pair& last) : head(first), tail(last) {}
    explicit Lanes6(const Column6& c) {
        std::memcpy(&head, c.v, sizeof(head));
        std::memcpy(&tail, c.v + 4, sizeof(tail));
    }
    void StoreTo(Column6& c) const {
        std::memcpy(c.v, &head, sizeof(head));
        std::memcpy(c.v + 4, &tail, sizeof(tail));
    }
    static Lanes6 Zero() { return {WideDouble::Double{}, Pair{}}; }

    friend Lanes6 operator+(const Lanes6& a, const Lanes6& b) { return {a.head + b.head, a.tail + b.tail}; }
    friend Lanes6 operator-(const Lanes6& a, const Lanes6& b) { return {a.head - b.head, a.tail - b.tail}; }
    friend Lanes6 operator*(const Lanes6& a, const Lanes6& b) { return {a.head * b.head, a.tail * b.tail}; }
    friend Lanes6 operator*(const Lanes6& a, double s) { return {a.head * s, a.tail * s}; }
};
inline double Sum(const Lanes6& a) {
    return ((a.head[0] + a.head[2]) + (a.head[1] + a.head[3])) + (a.tail[0] + a.tail[1]);
}
inline double Dot(const Column6& a, const Column6& b) { return Sum(Lanes6(a) * Lanes6(b)); }

// block += sum over rows of a b^T
inline void AddProducts(Block6& block, const Column6* a, const Column6* b, int rows) {
    for (int c = 0; c < 6; ++c) {
        Lanes6 sum(block.columns[c]);
        for (int r = 0; r < rows; ++r) sum = sum + Lanes6(a[r]) * b[r][c];
        sum.StoreTo(block.columns[c]);
    }
}

// block -= a b^T
inline void SubtractProduct(Block6& block, const Block6& a, const Block6& b) {
    Lanes6 columns[6];
    for (int k = 0; k < 6; ++k) columns[k] = Lanes6(a.columns[k]);
    for (int c = 0; c < 6; ++c) {
        Lanes6 sum(block.columns[c]);
        for (int k = 0; k < 6; ++k) sum = sum - columns[k] * b.columns[k][c];
        sum.StoreTo(block.columns[c]);
    }
}

}  // namespace fulcrum
