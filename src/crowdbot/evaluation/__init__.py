"""Evaluation of navigators and predictors: many trials, robots, seeds and recordings, with intervals and requirements.

Names are loaded on first use.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from crowdbot.lazy import lazy_exports

__getattr__, __dir__, __all__ = lazy_exports(__name__)


if TYPE_CHECKING:
    from .comparison import PairedComparison as PairedComparison
    from .comparison import paired_comparison as paired_comparison
    from .factor_sweep import FactorSweep as FactorSweep
    from .factor_sweep import parse_factors as parse_factors
    from .factor_sweep import sweep_trials as sweep_trials
    from .intervals import Estimate as Estimate
    from .intervals import bootstrap_estimate as bootstrap_estimate
    from .intervals import proportion_interval as proportion_interval
    from .job import RunRow as RunRow
    from .job import row_of as row_of
    from .job import row_values as row_values
    from .junit import junit_xml as junit_xml
    from .method import Method as Method
    from .method import own_method as own_method
    from .method import parse_methods as parse_methods
    from .method import with_safety as with_safety
    from .pareto import pareto_front as pareto_front
    from .plan import EvaluationCell as EvaluationCell
    from .plan import EvaluationPlan as EvaluationPlan
    from .plan import parse_robots as parse_robots
    from .plan import parse_seeds as parse_seeds
    from .prediction.degraded import DegradedScore as DegradedScore
    from .prediction.degraded import DegradedTask as DegradedTask
    from .prediction.degraded import sweep_degradations as sweep_degradations
    from .prediction.degraded_plot import plot_degradation as plot_degradation
    from .prediction.demo import Demo as Demo
    from .prediction.demo import run_demo as run_demo
    from .prediction.demo_report import PredictionResult as PredictionResult
    from .prediction.demo_report import write_demo_report as write_demo_report
    from .prediction.evaluation import PredictorEvaluation as PredictorEvaluation
    from .prediction.evaluation import PredictorJob as PredictorJob
    from .prediction.evaluation import PredictorJobResult as PredictorJobResult
    from .prediction.evaluation import PredictorResult as PredictorResult
    from .prediction.plots import animate_window as animate_window
    from .prediction.plots import plot_errors as plot_errors
    from .prediction.plots import plot_frames as plot_frames
    from .prediction.predictor_score import score_predictor as score_predictor
    from .prediction.window_results import FrameResults as FrameResults
    from .prediction.window_results import WindowResults as WindowResults
    from .prediction.window_results import predict_windows as predict_windows
    from .realism import ClearanceRow as ClearanceRow
    from .realism import ClearanceTable as ClearanceTable
    from .realism import CrowdRealism as CrowdRealism
    from .realism import load_clearances as load_clearances
    from .realism import model_digest as model_digest
    from .realism import realism_notice as realism_notice
    from .realism import trial_realism as trial_realism
    from .reality import FEWEST_RUNS as FEWEST_RUNS
    from .reality import RealPlacement as RealPlacement
    from .reality import place_reality as place_reality
    from .reality import reality_svg as reality_svg
    from .recorded_scans.annotated_scan import AnnotatedScan as AnnotatedScan
    from .recorded_scans.detection_scores import DetectionScores as DetectionScores
    from .recorded_scans.detection_scores import score_detections as score_detections
    from .recorded_scans.detection_scores import score_positions as score_positions
    from .recorded_scans.drow_files import read_drow as read_drow
    from .recorded_scans.frog_files import read_frog as read_frog
    from .recorded_scans.lcas_files import read_lcas as read_lcas
    from .recorded_scans.ogm_files import OGM_PERIOD as OGM_PERIOD
    from .recorded_scans.ogm_files import find_ogm_split as find_ogm_split
    from .recorded_scans.ogm_files import read_ogm as read_ogm
    from .recorded_scans.scan_bags import read_scan_bag as read_scan_bag
    from .report import write_report as write_report
    from .requirement import Requirement as Requirement
    from .requirement import RequirementVerdict as RequirementVerdict
    from .requirement import parse_requirement as parse_requirement
    from .result import CellResult as CellResult
    from .result import EvaluationResult as EvaluationResult
    from .result import load_evaluation as load_evaluation
    from .result import remark_lines as remark_lines
    from .result import result_schema as result_schema
    from .robot_recording import RobotRecording as RobotRecording
    from .robot_recording import load_robot_recording as load_robot_recording
    from .run_metrics import DECISION_METRICS as DECISION_METRICS
    from .run_metrics import PAIRED_FAMILIES as PAIRED_FAMILIES
    from .run_metrics import episode_log as episode_log
    from .run_metrics import episode_metrics as episode_metrics
    from .run_metrics import families_of as families_of
    from .runner import evaluate as evaluate
    from .scan_prediction.scan_plot import plot_scan_scores as plot_scan_scores
    from .scan_prediction.scan_scores import SCAN_SCORES as SCAN_SCORES
    from .scan_prediction.scan_scores import SOGMP as SOGMP
    from .scan_prediction.scan_scores import ScanProtocol as ScanProtocol
    from .scan_prediction.scan_scores import ScanScores as ScanScores
    from .scan_prediction.scan_scores import TruePeople as TruePeople
    from .scan_prediction.scan_scores import score_scans as score_scans
    from .statistic import Statistic as Statistic
    from .statistic import check_metrics as check_metrics
    from .statistic import metric_title as metric_title
    from .statistic import parse_statistic as parse_statistic
    from .sweep_effects import FactorEffect as FactorEffect
    from .sweep_effects import factor_effects as factor_effects
    from .tracking.camera_files import CameraCalibration as CameraCalibration
    from .tracking.camera_files import RobotOdometry as RobotOdometry
    from .tracking.camera_files import TruePaths as TruePaths
    from .tracking.camera_files import read_camera as read_camera
    from .tracking.camera_files import read_odometry as read_odometry
    from .tracking.camera_files import read_true_paths as read_true_paths
    from .tracking.downstream import DOWNSTREAM_INPUTS as DOWNSTREAM_INPUTS
    from .tracking.downstream import DOWNSTREAM_SCORES as DOWNSTREAM_SCORES
    from .tracking.downstream import estimate_downstream as estimate_downstream
    from .tracking.reading_log import LoggedReading as LoggedReading
    from .tracking.reading_log import ReadingLog as ReadingLog
    from .tracking.reading_log import log_readings as log_readings
    from .tracking.reading_log import read_readings as read_readings
    from .tracking.scan_statistics import BAND_LIMITS as BAND_LIMITS
    from .tracking.scan_statistics import ReturnsOfPeople as ReturnsOfPeople
    from .tracking.scan_statistics import scan_statistics as scan_statistics
    from .tracking.strata import STRATA as STRATA
    from .tracking.strata import estimate_strata as estimate_strata
    from .tracking.track_files import write_tracks as write_tracks
    from .tracking.track_plot import plot_tracks as plot_tracks
    from .tracking.tracking_run import TrackingRun as TrackingRun
    from .tracking.tracking_run import estimate_scores as estimate_scores
    from .tracking.tracking_run import track_people as track_people
    from .tracking.video_plot import plot_video_run as plot_video_run
    from .tracking.video_run import VideoForecast as VideoForecast
    from .tracking.video_run import VideoRun as VideoRun
    from .tracking.video_run import track_video as track_video
    from .trial_of_recording import recorded_trial as recorded_trial
    from .verdict import SafetyVerdict as SafetyVerdict
    from .verdict import judge_cell as judge_cell
    from .verdict import runs_without_event as runs_without_event
    from .worst_run import PersonContact as PersonContact
    from .worst_run import WorstRun as WorstRun
    from .worst_run import not_dangerous as not_dangerous
    from .worst_run import person_contacts as person_contacts
    from .worst_run import worst_rows as worst_rows
    from .worst_run import worst_runs as worst_runs
