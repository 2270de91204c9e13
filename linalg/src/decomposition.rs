//! Singular values, symmetric and general eigenvalues, rank, condition and least squares.

use faer::linalg::evd::hessenberg as householder;

use crate::dense::{copy, solve, view};
use crate::error::{Error, check_finite, check_range, check_shape, check_square, check_symmetric};
use crate::mat::{C64, CMat, Mat};
use crate::small_factors;
use crate::tolerance::EPS;

/// A thin singular value decomposition `A = U diag(s) V'`.
#[derive(Debug, Clone)]
pub struct Svd {
    /// Left singular vectors, m x k, k = min(m, n).
    pub U: Mat,
    /// Singular values, the largest first.
    pub s: Vec<f64>,
    /// Right singular vectors, n x k.
    pub V: Mat,
}

/// Returns the thin singular value decomposition.
///
/// # Errors
/// Entries that are not finite, or no convergence.
pub fn svd(A: &Mat) -> Result<Svd, Error> {
    check_finite("A", A)?;
    let parts = view(A).thin_svd().map_err(|_| no_convergence("the singular value decomposition"))?;
    let s = (0..A.nrows().min(A.ncols())).map(|i| parts.S()[i]).collect();
    Ok(Svd { U: copy(parts.U()), s, V: copy(parts.V()) })
}

/// Returns the singular values, the largest first.
///
/// # Errors
/// As for [`svd`].
pub fn singular_values(A: &Mat) -> Result<Vec<f64>, Error> {
    check_finite("A", A)?;
    view(A).singular_values().map_err(|_| no_convergence("the singular value decomposition"))
}

/// Returns the singular values of a complex matrix, the largest first.
///
/// # Errors
/// As for [`svd`].
pub fn csingular_values(A: &CMat) -> Result<Vec<f64>, Error> {
    check_finite("A", A)?;
    if A.nrows() == 1 || A.ncols() == 1 {
        return Ok(vec![A.norm_fro()]);
    }
    view(A).singular_values().map_err(|_| no_convergence("the singular value decomposition"))
}

/// Returns the largest singular value of a complex matrix, zero for one without entries.
///
/// Of two rows or columns it is the root of the larger eigenvalue of their Gram matrix, a sum of terms that are not negative, so that it is
/// as accurate as by the decomposition.
///
/// # Errors
/// As for [`svd`].
pub fn largest_singular_value(A: &CMat) -> Result<f64, Error> {
    check_finite("A", A)?;
    let (rows, cols) = A.shape();
    let size = A.as_slice().iter().map(|e| e.re.abs().max(e.im.abs())).fold(0.0, f64::max);
    if rows.min(cols) != 2 || !size.is_normal() {
        return Ok(csingular_values(A)?.first().copied().unwrap_or(0.0));
    }
    let scale = power_of_two(1.0 / size);
    let entry = |line: usize, k: usize| scale * if rows == 2 { A[(line, k)] } else { A[(k, line)] };
    let (mut first, mut second, mut cross) = (0.0, 0.0, C64::default());
    for k in 0..rows.max(cols) {
        let (a, b) = (entry(0, k), entry(1, k));
        first += a.norm_sqr();
        second += b.norm_sqr();
        cross += a * b.conj();
    }
    let larger = 0.5 * (first + second + (first - second).hypot(2.0 * cross.norm()));
    Ok(larger.sqrt() / scale)
}

/// A thin complex singular value decomposition `A = U diag(s) V^H`.
#[derive(Debug, Clone)]
pub struct CSvd {
    /// Left singular vectors, m x k.
    pub U: CMat,
    /// Singular values, the largest first.
    pub s: Vec<f64>,
    /// Right singular vectors, n x k.
    pub V: CMat,
}

/// Returns the thin singular value decomposition of a complex matrix.
///
/// # Errors
/// As for [`svd`].
pub fn csvd(A: &CMat) -> Result<CSvd, Error> {
    check_finite("A", A)?;
    let parts = view(A).thin_svd().map_err(|_| no_convergence("the singular value decomposition"))?;
    let s = (0..A.nrows().min(A.ncols())).map(|i| parts.S()[i].re).collect();
    Ok(CSvd { U: copy(parts.U()), s, V: copy(parts.V()) })
}

/// Returns the eigenvalues, the smallest first, and orthonormal eigenvectors of a symmetric matrix: `A V = V diag(values)`.
///
/// # Errors
/// Not square, not finite, not symmetric, or no convergence.
pub fn sym_eigen(A: &Mat) -> Result<(Vec<f64>, Mat), Error> {
    use faer::dyn_stack::{MemBuffer, MemStack};
    use faer::linalg::evd;
    check_symmetric("A", A)?;
    let n = A.nrows();
    let mut params: evd::SelfAdjointEvdParams = faer::Auto::<f64>::auto();
    // Divide and conquer, faer 0.24's way above n = 128, misses graded matrices by 3e-4 of their norm; QR does not.
    params.recursion_threshold = usize::MAX;
    let seq = faer::Par::Seq;
    let need = evd::self_adjoint_evd_scratch::<f64>(n, evd::ComputeEigenvectors::Yes, seq, params.into());
    let mut buffer = MemBuffer::new(need);
    let (mut values, mut vectors) = (faer::Col::<f64>::zeros(n), faer::Mat::<f64>::zeros(n, n));
    let (s, U) = (values.as_diagonal_mut(), Some(vectors.as_mut()));
    evd::self_adjoint_evd(view(A), s, U, seq, MemStack::new(&mut buffer), params.into())
        .map_err(|_| no_convergence("the symmetric eigenproblem"))?;
    Ok(((0..n).map(|i| values[i]).collect(), copy(vectors.as_ref())))
}

/// Returns the eigenvalues of a symmetric matrix, the smallest first.
///
/// # Errors
/// As for [`sym_eigen`].
pub fn sym_eigenvalues(A: &Mat) -> Result<Vec<f64>, Error> {
    check_symmetric("A", A)?;
    view(A)
        .self_adjoint_eigenvalues(faer::Side::Lower)
        .map_err(|_| no_convergence("the symmetric eigenproblem"))
}

/// Solves the symmetric-definite problem `K v = lambda M v`, the smallest eigenvalue first, with `V' M V = I`.
///
/// `K` symmetric, `M` symmetric positive definite. Method: Cholesky `M = L L'`, then the eigenvalues of `L^-1 K L^-T`,
/// after a diagonal power-of-two scaling that gives `M` a unit diagonal (masses and inertias differ by many decades).
///
/// # Errors
/// Wrong shapes, not symmetric, or a mass matrix that is not positive definite.
pub fn sym_gen_eigen(K: &Mat, M: &Mat) -> Result<(Vec<f64>, Mat), Error> {
    check_symmetric("K", K)?;
    check_symmetric("M", M)?;
    check_shape("M", M, K.nrows(), K.ncols())?;
    let scale: Vec<f64> =
        M.diagonal().iter().map(|&m| power_of_two(1.0 / m.abs().max(f64::MIN_POSITIVE).sqrt())).collect();
    let scaled = |A: &Mat| Mat::from_fn(A.nrows(), A.ncols(), |i, j| scale[i] * A[(i, j)] * scale[j]);
    let L = crate::dense::cholesky(&scaled(M)).map_err(|_| Error::NotPositiveDefinite { what: "M" })?;
    let left = lower_solve(&L, &scaled(K));
    let reduced = lower_solve(&L, &left.t()).symmetric_part();
    let (values, vectors) = sym_eigen(&reduced)?;
    let inner = lower_transpose_solve(&L, &vectors);
    Ok((values, Mat::from_fn(inner.nrows(), inner.ncols(), |i, j| scale[i] * inner[(i, j)])))
}

/// The power of two nearest to a positive number, on the logarithmic scale, from 2^-1000 to 2^1000.
pub(crate) fn power_of_two(value: f64) -> f64 {
    const ONE: i64 = 1023;
    let bits = value.to_bits();
    let mantissa = f64::from_bits((bits & ((1 << 52) - 1)) | ((ONE as u64) << 52));
    let exponent = (bits >> 52) as i64 + i64::from(mantissa > std::f64::consts::SQRT_2);
    f64::from_bits((exponent.clamp(ONE - 1000, ONE + 1000) as u64) << 52)
}

fn lower_solve(L: &Mat, B: &Mat) -> Mat {
    let mut X = B.clone();
    view(L).solve_lower_triangular_in_place(crate::dense::view_mut(&mut X));
    X
}

fn lower_transpose_solve(L: &Mat, B: &Mat) -> Mat {
    let mut X = B.clone();
    view(L).transpose().solve_upper_triangular_in_place(crate::dense::view_mut(&mut X));
    X
}

/// Returns the Hessenberg form `A = U H U'`: `H` zero below the first subdiagonal, `U` orthogonal.
///
/// Method: Householder reflections (faer).
///
/// # Errors
/// Not square or not finite.
pub fn hessenberg(A: &Mat) -> Result<(Mat, Mat), Error> {
    check_square("A", A)?;
    let n = A.nrows();
    if n < 3 {
        return Ok((A.clone(), Mat::eye(n)));
    }
    let (least, most) = crate::tolerance::SAFE_ENTRIES;
    if n <= small_factors::SIMILARITIES && (least..most).contains(&A.norm_max()) {
        let mut H = A.clone();
        let Q = small_factors::hessenberg(&mut H);
        return Ok((H, Q));
    }
    Ok(blocked_hessenberg(A))
}

/// The Hessenberg form of [`hessenberg`] alone.
pub(crate) fn hessenberg_values(A: &Mat) -> Result<Mat, Error> {
    check_square("A", A)?;
    let n = A.nrows();
    let mut H = A.clone();
    let (least, most) = crate::tolerance::SAFE_ENTRIES;
    if n < 3 {
        return Ok(H);
    }
    if n <= small_factors::SIMILARITIES && (least..most).contains(&A.norm_max()) {
        small_factors::hessenberg_values(&mut H);
        return Ok(H);
    }
    Ok(upper_hessenberg(&blocked_reduction(A).0))
}

/// The upper triangle and the first subdiagonal.
fn upper_hessenberg(work: &faer::Mat<f64>) -> Mat {
    Mat::from_fn(work.nrows(), work.ncols(), |i, j| if i <= j + 1 { work[(i, j)] } else { 0.0 })
}

/// [`hessenberg`] of a finite square matrix with at least three rows, by faer's kernel.
fn blocked_hessenberg(A: &Mat) -> (Mat, Mat) {
    use faer::dyn_stack::{MemBuffer, MemStack};
    use faer::linalg::householder as apply;
    let n = A.nrows();
    let (work, coefficients) = blocked_reduction(A);
    let mut Q = faer::Mat::<f64>::identity(n, n);
    let block = coefficients.nrows();
    let need =
        apply::apply_block_householder_sequence_on_the_left_in_place_scratch::<f64>(n - 1, block, n - 1);
    let mut buffer = MemBuffer::new(need);
    apply::apply_block_householder_sequence_on_the_left_in_place_with_conj(
        work.as_ref().submatrix(1, 0, n - 1, n - 1),
        coefficients.as_ref(),
        faer::Conj::No,
        Q.as_mut().submatrix_mut(1, 1, n - 1, n - 1),
        faer::Par::Seq,
        MemStack::new(&mut buffer),
    );
    (upper_hessenberg(&work), copy(Q.as_ref()))
}

/// The Hessenberg form with the reflections below it, and the factors of these.
fn blocked_reduction(A: &Mat) -> (faer::Mat<f64>, faer::Mat<f64>) {
    use faer::dyn_stack::{MemBuffer, MemStack};
    let n = A.nrows();
    let block = faer::linalg::qr::no_pivoting::factor::recommended_block_size::<f64>(n - 1, n - 1);
    let mut work = view(A).to_owned();
    let mut coefficients = faer::Mat::<f64>::zeros(block, n - 1);
    let seq = faer::Par::Seq;
    let need = householder::hessenberg_in_place_scratch::<f64>(n, block, seq, Default::default());
    let mut buffer = MemBuffer::new(need);
    householder::hessenberg_in_place(
        work.as_mut(),
        coefficients.as_mut(),
        seq,
        MemStack::new(&mut buffer),
        Default::default(),
    );
    (work, coefficients)
}

/// Returns the generalised eigenvalues of the pencil `A - lambda E` as pairs (alpha, beta), `lambda = alpha / beta`; an infinite
/// eigenvalue has `beta = 0`, an undetermined one (a singular pencil) both zero. By QZ; the order is not specified.
///
/// # Errors
/// Wrong shapes, entries that are not finite, or no convergence.
pub fn gen_eigenvalues(A: &Mat, E: &Mat) -> Result<Vec<(C64, f64)>, Error> {
    use faer::dyn_stack::{MemBuffer, MemStack};
    use faer::linalg::gevd;
    check_square("A", A)?;
    check_shape("E", E, A.nrows(), A.ncols())?;
    let n = A.nrows();
    let mut params: gevd::GevdParams = faer::Auto::<f64>::auto();
    // The blocked QZ of faer 0.24 stalls between n = 75 and 130.
    params.schur.blocking_threshold = usize::MAX;
    let (mut left, mut right) = (view(A).to_owned(), view(E).to_owned());
    let (mut re, mut im, mut beta) =
        (faer::Col::<f64>::zeros(n), faer::Col::<f64>::zeros(n), faer::Col::<f64>::zeros(n));
    let no = gevd::ComputeEigenvectors::No;
    let need = gevd::gevd_scratch::<f64>(n, no, no, faer::Par::Seq, params.into());
    let mut buffer = MemBuffer::new(need);
    gevd::gevd_real(
        left.as_mut(),
        right.as_mut(),
        re.as_diagonal_mut(),
        im.as_diagonal_mut(),
        beta.as_diagonal_mut(),
        None,
        None,
        faer::Par::Seq,
        MemStack::new(&mut buffer),
        params.into(),
    )
    .map_err(|_| no_convergence("the QZ iteration"))?;
    // faer 0.24 gives the second of a complex pair the beta of the first with an alpha of its own scale: only the
    // first can be trusted.
    for i in 1..n {
        if im[i - 1] > 0.0 {
            (re[i], im[i], beta[i]) = (re[i - 1], -im[i - 1], beta[i - 1]);
        }
    }
    Ok((0..n).map(|i| (C64::new(re[i], im[i]), beta[i])).collect())
}

/// Returns the numerical rank: how many singular values exceed `relative` times the largest.
///
/// # Errors
/// Entries that are not finite.
pub fn rank(A: &Mat, relative: f64) -> Result<usize, Error> {
    let s = singular_values(A)?;
    let floor = relative * s.first().copied().unwrap_or(0.0);
    Ok(s.iter().filter(|&&value| value > floor).count())
}

/// Returns the default relative tolerance of a rank: `max(m, n) eps`.
pub fn rank_tolerance(A: &Mat) -> f64 {
    A.nrows().max(A.ncols()) as f64 * EPS
}

/// Returns the condition number in the 2-norm, infinite for a singular matrix.
///
/// # Errors
/// Entries that are not finite.
pub fn cond(A: &Mat) -> Result<f64, Error> {
    let s = singular_values(A)?;
    Ok(match (s.first(), s.last()) {
        (Some(_), Some(&0.0)) => f64::INFINITY,
        (Some(&largest), Some(&smallest)) => largest / smallest,
        _ => 1.0,
    })
}

/// Returns the reciprocal condition number in the 1-norm, computed from the inverse; 0 for a singular matrix.
pub fn rcond_one(A: &Mat) -> f64 {
    let n = A.nrows();
    match solve(A, &Mat::eye(n)) {
        Ok(inverse) => 1.0 / (A.norm_one() * inverse.norm_one()),
        Err(_) => 0.0,
    }
}

/// Returns the least-squares solution of `A X = B` with the smallest norm, by singular values; those below `max(m, n) eps s_max`
/// count as zero.
///
/// # Errors
/// Wrong shapes, entries that are not finite.
pub fn lstsq(A: &Mat, B: &Mat) -> Result<Mat, Error> {
    check_shape("B", B, A.nrows(), B.ncols())?;
    check_range("the solution by least squares", pinv(A)? * B)
}

/// Returns the Moore-Penrose inverse by singular values; those below `max(m, n) eps s_max` count as zero.
///
/// # Errors
/// Entries that are not finite.
pub fn pinv(A: &Mat) -> Result<Mat, Error> {
    let parts = svd(A)?;
    let floor = A.nrows().max(A.ncols()) as f64 * EPS * parts.s.first().copied().unwrap_or(0.0);
    let reciprocal: Vec<f64> = parts.s.iter().map(|&s| if s > floor { 1.0 / s } else { 0.0 }).collect();
    check_range("the pseudoinverse", &parts.V * &Mat::diag(&reciprocal) * parts.U.t())
}

fn no_convergence(what: &'static str) -> Error {
    Error::NoConvergence { what, limit: crate::tolerance::QR_ITERATIONS }
}
