#![allow(warnings)]
use counterpoise_linalg::*;
use std::time::Instant;
fn t(name:&str, mut f: impl FnMut()) { let mut b=f64::INFINITY; for _ in 0..2000 { let s=Instant::now(); f(); b=b.min(s.elapsed().as_secs_f64()); } println!("{name:30} {:.2} us", b*1e6); }
fn main(){
 for n in [10usize,20,50] {
  let mut x=1u64; let mut r=||{x=x.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407); ((x>>33) as f64)/(1u64<<31) as f64-0.5};
  let a=Mat::from_fn(n,n,|_,_|r()); let big=Mat::from_fn(2*n,2*n,|_,_|r()); let b=Mat::from_fn(n,2,|_,_|r());
  let sym=(&a+&a.t()); 
  println!("n={n}");
  t("schur n",||{std::hint::black_box(schur(&a).unwrap());});
  t("schur 2n",||{std::hint::black_box(schur(&big).unwrap());});
  t("hess 2n",||{std::hint::black_box(hessenberg(&big).unwrap());});
  let s=schur(&big).unwrap();
  t("reorder 2n",||{let mut s=s.clone(); s.reorder(|l|l.re<0.0).unwrap();});
  let ast=&a-&Mat::eye(n).scale(3.0);
  t("lyap n",||{std::hint::black_box(lyap(&ast,&sym).unwrap());});
  t("solve n",||{std::hint::black_box(solve(&a,&big.block(0,0,n,2*n)).unwrap());});
  t("inverse n",||{std::hint::black_box(inverse(&a).unwrap());});
  t("gemm n",||{std::hint::black_box(&a*&sym);});
  t("transpose n",||{std::hint::black_box(a.t());});
  t("add n",||{std::hint::black_box(&a+&sym);});
  t("symmetric_part n",||{std::hint::black_box(a.symmetric_part());});
  t("norm_fro n",||{std::hint::black_box(a.norm_fro());});
  t("expm n",||{std::hint::black_box(expm(&a).unwrap());});
  t("balance",||{std::hint::black_box(balance(&a).unwrap());});
  t("eigenvalues n",||{std::hint::black_box(eigenvalues(&a).unwrap());});
  let q=Mat::eye(n);let rr=Mat::eye(2);
  if let Ok(Outcome::Solved(s)) = care(&a,&b,&q,&rr,None).map(|o| o) { println!("{}", s.certificate);}
  t("care n",||{std::hint::black_box(care(&a,&b,&q,&rr,None).unwrap());});
 }
}
