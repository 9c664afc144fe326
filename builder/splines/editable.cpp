#include "builder/splines/editable.h"

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <string>

#include "builder/splines/rows.h"
#include "builder/splines/saddle.h"
#include "geometry/error.h"

namespace fascia::splines {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

template <class T>
void erase_at(std::vector<T>& values, int at) {
  if (!values.empty()) values.erase(values.begin() + at);
}

void add_weight(std::vector<double>& weights, int count_before, double weight) {
  if (weights.empty() && weight == 1) return;
  if (weights.empty()) weights.assign(static_cast<size_t>(count_before), 1);
  weights.push_back(weight);
}

// Sites left on a line or plane make the bordered system singular; factored anew it is not.
bool determines(const MatrixXd& polynomial) {
  if (polynomial.rows() < polynomial.cols()) return false;
  Eigen::ColPivHouseholderQR<MatrixXd> qr;
  qr.setThreshold(1e-8);
  return qr.compute(polynomial).rank() == polynomial.cols();
}

void check_index(int at, int count, const char* what) {
  if (at < 0 || at >= count)
    throw Error(std::string("spline: ") + what + " " + std::to_string(at) + " of " + std::to_string(count));
}

}  // namespace

// With the factored matrix M, rows A added and rows R removed the system is
//   [ M    B  E ] [ c, a ]   [ y   ]
//   [ B^T  C  0 ] [ c_A  ] = [ y_A ]
//   [ E^T  0  0 ] [ s    ]   [ 0   ]
// E holds unit columns of R: c_R = 0, and s takes up whatever the datum there says. Its Schur complement
// [C 0; 0 0] - [B E]^T M^-1 [B E] is small.
struct EditableFactorisation::State {
  /// One column of the border: a row added to the factored ones, or one of them taken out of use.
  struct Column {
    int removed = -1;  ///< factored row, -1 for an added row
    Row added;
  };

  Sites sites;
  SplineOptions options;
  int edit_limit = 0;
  System system;
  std::vector<Row> base;        // the factored rows
  std::vector<Column> columns;  // of the border
  std::vector<int> place;       // of each current row: factored row, or -1 - column
  SaddleSolver solver;
  MatrixXd border;   // [B E], factored rows + monomials
  MatrixXd carried;  // M^-1 [B E]
  Eigen::PartialPivLU<MatrixXd> schur;

  int monomials() const { return static_cast<int>(system.monomials.size()); }
  std::vector<Row> rows() const;
  void factor();
  void border_with(Column column);
  void drop(size_t row);
  void complement();
  void change(const Sites& changed, size_t dropped, const Row* fresh, size_t at);
};

std::vector<Row> EditableFactorisation::State::rows() const {
  std::vector<Row> out;
  for (int at : place)
    out.push_back(at >= 0 ? base[static_cast<size_t>(at)] : columns[static_cast<size_t>(-1 - at)].added);
  return out;
}

void EditableFactorisation::State::factor() {
  system = make_system(sites, options);
  base = make_rows(system, sites);
  columns.clear();
  place.resize(base.size());
  for (size_t i = 0; i < place.size(); ++i)
    place[i] = static_cast<int>(i);
  if (!solver.compute(system.kernel_matrix(base), system.polynomial_matrix(base), system.definite))
    throw_singular(system, base);
  border.resize(static_cast<Index>(base.size()) + monomials(), 0);
  carried = border;
}

void EditableFactorisation::State::border_with(Column column) {
  const Index n = static_cast<Index>(base.size());
  VectorXd entries = VectorXd::Zero(n + monomials());
  if (column.removed >= 0) {
    entries[column.removed] = 1;
  } else {
    for (Index i = 0; i < n; ++i)
      entries[i] = system.entry(base[static_cast<size_t>(i)], column.added);
    entries.tail(monomials()) = system.polynomial_row(column.added);
  }
  MatrixXd c, a;
  solver.solve(entries.head(n), entries.tail(monomials()), c, a);
  border.conservativeResize(Eigen::NoChange, border.cols() + 1);
  carried.conservativeResize(Eigen::NoChange, carried.cols() + 1);
  border.rightCols(1) = entries;
  carried.rightCols(1) << c, a;
  columns.push_back(column);
}

void EditableFactorisation::State::drop(size_t row) {
  const int at = place[row];
  place.erase(place.begin() + static_cast<std::ptrdiff_t>(row));
  if (at >= 0) {
    border_with({at, {}});
    return;
  }
  const Index column = -1 - at, after = border.cols() - column - 1;
  for (MatrixXd* matrix : {&border, &carried}) {
    matrix->middleCols(column, after) = matrix->rightCols(after).eval();
    matrix->conservativeResize(Eigen::NoChange, matrix->cols() - 1);
  }
  columns.erase(columns.begin() + column);
  for (int& other : place)
    if (other < at) ++other;
}

void EditableFactorisation::State::complement() {
  if (columns.empty()) return;
  MatrixXd S = -border.transpose() * carried;
  for (size_t i = 0; i < columns.size(); ++i)
    for (size_t j = 0; j < columns.size(); ++j)
      if (columns[i].removed < 0 && columns[j].removed < 0)
        S(static_cast<Index>(i), static_cast<Index>(j)) +=
            system.entry(columns[i].added, columns[j].added) + (i == j ? columns[i].added.ridge : 0);
  schur.compute(S);
}

// Drops row `dropped` and puts `fresh` at `at`, either or both; `changed` are the sites after that.
void EditableFactorisation::State::change(const Sites& changed, size_t dropped, const Row* fresh, size_t at) {
  std::vector<Row> after = rows();
  if (dropped < after.size()) after.erase(after.begin() + static_cast<std::ptrdiff_t>(dropped));
  if (fresh) after.insert(after.begin() + static_cast<std::ptrdiff_t>(at), *fresh);
  check_duplicates(after, system.options.dimension);
  const bool anew = border.cols() + 2 > edit_limit || solver.rank() < monomials() ||
                    columns.size() + 2 > base.size() || !determines(system.polynomial_matrix(after));
  const Sites before = sites;
  sites = changed;
  if (anew) {
    try {
      factor();
    } catch (...) {
      sites = before;
      factor();
      throw;
    }
    return;
  }
  if (dropped < place.size()) drop(dropped);
  if (fresh) {
    border_with({-1, *fresh});
    place.insert(place.begin() + static_cast<std::ptrdiff_t>(at), -static_cast<int>(columns.size()));
  }
  complement();
  // A last guard: rows so many or so near that the border has lost too many digits.
  if (!columns.empty() && !(schur.rcond() > 1e-12)) factor();
}

EditableFactorisation::EditableFactorisation(const Sites& sites, const SplineOptions& options, int edit_limit)
    : state_(std::make_unique<State>()) {
  state_->sites = sites;
  state_->options = options;
  state_->edit_limit = edit_limit > 0 ? edit_limit : std::max(16, sites.rows() / 10);
  state_->factor();
}

EditableFactorisation::~EditableFactorisation() = default;
EditableFactorisation::EditableFactorisation(EditableFactorisation&&) noexcept = default;
EditableFactorisation& EditableFactorisation::operator=(EditableFactorisation&&) noexcept = default;

const Sites& EditableFactorisation::sites() const {
  return state_->sites;
}
int EditableFactorisation::border() const {
  return static_cast<int>(state_->columns.size());
}

void EditableFactorisation::add_value(const Vec3& point, double weight) {
  if (!point.allFinite()) throw Error("spline: the added point is not finite");
  const Row row = state_->system.value_row(point, weight);
  Sites sites = state_->sites;
  add_weight(sites.weights, sites.value_count(), weight);
  sites.points.push_back(point);
  state_->change(sites, state_->place.size(), &row, static_cast<size_t>(sites.value_count() - 1));
}

void EditableFactorisation::move_value(int value, const Vec3& point) {
  check_index(value, state_->sites.value_count(), "value");
  if (!point.allFinite()) throw Error("spline: the moved point is not finite");
  Sites sites = state_->sites;
  sites.points[static_cast<size_t>(value)] = point;
  const double weight = sites.weights.empty() ? 1 : sites.weights[static_cast<size_t>(value)];
  const Row row = state_->system.value_row(point, weight);
  state_->change(sites, static_cast<size_t>(value), &row, static_cast<size_t>(value));
}

void EditableFactorisation::remove_value(int value) {
  check_index(value, state_->sites.value_count(), "value");
  Sites sites = state_->sites;
  erase_at(sites.points, value);
  erase_at(sites.weights, value);
  if (sites.rows() == 0) throw Error("spline: the last datum cannot be removed");
  state_->change(sites, static_cast<size_t>(value), nullptr, 0);
}

void EditableFactorisation::add_derivative(const Vec3& point, const Vec3& direction, double weight) {
  if (!point.allFinite() || !direction.allFinite()) throw Error("spline: the added derivative is not finite");
  const Row row = state_->system.derivative_row(point, direction, weight);
  Sites sites = state_->sites;
  add_weight(sites.derivative_weights, sites.derivative_count(), weight);
  sites.add_derivative(point, direction);
  state_->change(sites, state_->place.size(), &row, state_->place.size());
}

void EditableFactorisation::remove_derivative(int derivative) {
  check_index(derivative, state_->sites.derivative_count(), "derivative");
  Sites sites = state_->sites;
  erase_at(sites.derivative_points, derivative);
  erase_at(sites.derivative_directions, derivative);
  erase_at(sites.derivative_weights, derivative);
  if (sites.rows() == 0) throw Error("spline: the last datum cannot be removed");
  state_->change(sites, static_cast<size_t>(sites.value_count() + derivative), nullptr, 0);
}

Spline EditableFactorisation::solve(const MatrixXd& data) const {
  const State& s = *state_;
  const std::vector<Row> rows = s.rows();
  const MatrixXd local = local_data(rows, data);
  const Index n = static_cast<Index>(s.base.size()), k = static_cast<Index>(s.columns.size());
  MatrixXd top = MatrixXd::Zero(n, data.cols()), side = MatrixXd::Zero(k, data.cols());
  for (size_t i = 0; i < rows.size(); ++i) {
    const Index r = static_cast<Index>(i);
    if (s.place[i] >= 0)
      top.row(s.place[i]) = local.row(r);
    else
      side.row(-1 - s.place[i]) = local.row(r);
  }
  MatrixXd c, a;
  s.solver.solve(top, MatrixXd(), c, a);
  if (k > 0) {
    MatrixXd whole(n + a.rows(), data.cols());
    whole << c, a;
    side = s.schur.solve(side - s.border.transpose() * whole).eval();
    whole -= s.carried * side;
    c = whole.topRows(n);
    a = whole.bottomRows(a.rows());
  }
  MatrixXd weights(static_cast<Index>(rows.size()), data.cols());
  for (size_t i = 0; i < rows.size(); ++i)
    weights.row(static_cast<Index>(i)) = s.place[i] >= 0 ? c.row(s.place[i]) : side.row(-1 - s.place[i]);
  return make_spline(s.system, rows, local, weights, a);
}

}  // namespace fascia::splines
