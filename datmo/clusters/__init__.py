"""Clusters: elevated points that belong together."""

from datmo.clusters.config import ClusterConfig, MergeConfig
from datmo.clusters.label import cluster
from datmo.clusters.merge import merge_clusters

__all__ = ["ClusterConfig", "MergeConfig", "cluster", "merge_clusters"]
